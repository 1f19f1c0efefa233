// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/fast_slam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ram_slam/fast_slam/association_candidates.hpp"
#include "ram_slam/fast_slam/landmark_existence.hpp"
#include "ram_slam/fast_slam/landmark_records.hpp"
#include "ram_slam/fast_slam/map_summary.hpp"
#include "ram_slam/fast_slam/pose_estimate.hpp"
#include "ram_slam/fast_slam/resampling.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {
FastSlam::FastSlam(const FastSlamParameters& parameters,
                   FeatureMatchers matchers,
                   const PoseWithCovariance2& map_from_base)
    : parameters_(parameters),
      matchers_(std::move(matchers)),
      proposal_(makeProposal(parameters)),
      drift_(parameters.drift_yaw_arm_m),
      shared_error_(parameters.shared_error) {
  parameters_.validate();
  particles_.resize(parameters_.particle_amount);
  setPose(map_from_base);
}

void FastSlam::setPose(const PoseWithCovariance2& map_from_base) {
  requireGood(map_from_base);
  const Particle kept = particles_[best_];
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    particles_[i] = kept;
    particles_[i].log_weight = 0.0;
    particles_[i].proposal = map_from_base;
    particles_[i].map_from_base = samplePose(
        map_from_base, Random(parameters_.seed, update_count_, 2 * particles_.size() + i));
  }
  best_ = 0;
  estimate_ = map_from_base;
  drift_.reset(map_from_base);
  since_update_ = {};
}

void FastSlam::setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) {
  requireNotOlder(stamp_ns, stamp_ns_);
  setPose(map_from_base);
  stamp_ns_ = stamp_ns;
}

void FastSlam::setMap(const LandmarkMap& map, const Trajectory& path) {
  validate(path);
  LandmarkRegistry registry;
  LandmarkTree landmarks;
  for (const LandmarkEstimate& estimate : map.landmarks) {
    LandmarkRecord record = recordOf(estimate, matchers_, parameters_);
    registry.restore(std::move(record));
    landmarks.set(estimate.id, {estimate.mean_m, estimate.covariance_m2});
  }
  registry.skip(static_cast<LandmarkId>(parameters_.skipped_ids));
  Path driven;
  for (const StampedPose2& pose : path) driven.append(pose);
  registry_ = std::move(registry);
  shared_error_.forget();
  is_map_loaded_ = path.empty();
  for (Particle& particle : particles_) {
    particle.landmarks = landmarks;
    particle.path = driven;
  }
  for (LandmarkRecord& record : registry_.records())
    refreshBounds(record, particles_, parameters_.creation_gate);
}

void FastSlam::update(const FeatureList& list, const MotionModel& model, const FieldOfView* view) {
  check(list);
  update(list, motionStep(model, stamp_ns_, list.stamp_ns), view);
}

void FastSlam::update(const FeatureList& list, const MotionStep& step, const FieldOfView* view) {
  check(list);
  const std::vector<DescriptorPointer> descriptors = describe(list, matchers_);
  PoseWithCovariance2 since_list;
  if (started() && step.to_ns != stamp_ns_) since_list = step.motion;
  const PoseWithCovariance2 since_update = since_update_ * since_list;
  if (!since_update.pose.isFinite() || !since_update.covariance.allFinite())
    throw std::invalid_argument("the motion model gives a motion that is not finite");
  const std::vector<PoseWithCovariance2> predicted =
      proposal_->predict(particles_, {stamp_ns_, step.to_ns, since_list, step.model}, since_update,
                         Random(parameters_.seed, update_count_ + 1)());
  // From here on nothing fails.
  const bool is_update_due =
      updated_ns_ == 0 ||
      proposal_->isUpdateDue(list, since_update.pose, list.stamp_ns == updated_ns_);
  stamp_ns_ = list.stamp_ns;
  ++update_count_;
  since_update_ = since_update;
  PoseWithCovariance2 drifted = since_list;
  drifted.covariance *= parameters_.drift_inflation;
  drift_.move(estimate_.pose, drifted);
  for (std::size_t i = 0; i < particles_.size(); ++i) particles_[i].proposal = predicted[i];
  const std::vector<Observation> observations =
      AssociationCandidates(parameters_, matchers_, registry_, particles_, best_)
          .observe(list, descriptors);
  const std::vector<Evidence> evidence = weigh(observations);
  if (proposal_->coversSharedErrors()) coverErrors(since_list.pose.translation().norm());
  if (!is_update_due) return;
  updated_ns_ = stamp_ns_;
  since_update_ = {};
  samplePoses(evidence);
  if (!is_map_fixed_) {
    updateMaps(list, descriptors, observations, evidence);
    const LandmarkExistence existence(parameters_, particles_, weightsOf(particles_));
    for (const LandmarkId id : existence.update(registry_, view, estimate_.pose)) remove(id);
  }
  resample();
}

std::vector<Evidence> FastSlam::weigh(const std::vector<Observation>& observations) {
  std::vector<Evidence> evidence;
  evidence.reserve(particles_.size());
  std::vector<double> log_weights;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle& particle = particles_[i];
    evidence.push_back(
        proposal_->associate(observations, particle,
                             Random(parameters_.seed, update_count_, 3 * particles_.size() + i)));
    particle.proposal = evidence.back().map_from_base;
    particle.path.append({stamp_ns_, particle.proposal.pose}, parameters_.path.step);
    log_weights.push_back(particle.log_weight +
                          parameters_.evidence_exponent * evidence.back().log_likelihood_ratio);
  }
  limitPaths(particles_, best_, static_cast<std::size_t>(parameters_.path.max_poses));
  const std::vector<double> weights = normalisedWeights(log_weights);
  estimate_ = estimatePose(particles_, weights);
  quality_.effective_fraction = effectiveCount(weights) / static_cast<double>(weights.size());
  const Evidence& best = evidence[largest(weights)];
  associations_ = best.associations;
  quality_.add(best, parameters_.quality_memory);
  return evidence;
}

void FastSlam::coverErrors(double moved_m) {
  const MapDrift open = drift_;
  for (const Association& association : associations_) {
    if (association.outcome != AssociationOutcome::kMatched) continue;
    const LandmarkRecord& record = *registry_.find(association.id);
    if (record.existence_log_odds < parameters_.confirm_log_odds) continue;
    drift_.fallBack(record.drift, estimate_);
  }
  drift_.cover(estimate_);
  for (LandmarkRecord& record : registry_.records())
    record.drift = drift_.bridged(record.drift, open, record.bounds_m.center());
  shared_error_.move(moved_m, estimate_.pose.translation());
  estimate_.covariance =
      drift_.at(estimate_.pose) + shared_error_.covariance(parameters_.pose_noise_floor);
}

void FastSlam::samplePoses(const std::vector<Evidence>& evidence) {
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle& particle = particles_[i];
    particle.log_weight += parameters_.evidence_exponent * evidence[i].log_likelihood_ratio;
    particle.map_from_base =
        samplePose(particle.proposal, Random(parameters_.seed, update_count_, i));
    particle.path.append({stamp_ns_, particle.map_from_base}, parameters_.path.step);
  }
  const std::vector<double> weights = weightsOf(particles_);
  best_ = largest(weights);
  // Relative to the best, so that they stay in range.
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    particles_[i].log_weight = std::log(weights[i] / weights[best_]);
  }
}

std::vector<Pose2> FastSlam::hypotheses() const {
  std::vector<Pose2> poses;
  for (const Particle& particle : particles_) poses.push_back(particle.proposal.pose);
  return poses;
}

std::vector<std::pair<std::string, double>> FastSlam::health() const {
  return {{"features matched recently", quality_.matched_fraction},
          {"normalised innovation", quality_.normalised_innovation},
          {"effective particles", quality_.effective_fraction},
          {"poses of the path", static_cast<double>(best().path.size())}};
}

LandmarkMap FastSlam::landmarks() const {
  LandmarkMap map =
      summarise(registry_, best(), particles_, weightsOf(particles_), parameters_.summary);
  map.stamp_ns = stamp_ns_;
  return map;
}

void FastSlam::remove(LandmarkId id) {
  registry_.remove(id);
  for (Particle& particle : particles_) particle.landmarks.erase(id);
}

void FastSlam::forgetAbandoned() {
  std::vector<LandmarkId> abandoned;
  for (const LandmarkRecord& record : registry_.records()) {
    const bool held =
        particles_[best_].landmarks.find(record.id) != nullptr ||
        std::any_of(particles_.begin(), particles_.end(), [&record](const Particle& particle) {
          return particle.landmarks.find(record.id) != nullptr;
        });
    if (!held) abandoned.push_back(record.id);
  }
  for (const LandmarkId id : abandoned) registry_.remove(id);
}

void FastSlam::unshare() {
  for (Particle& particle : particles_) particle.landmarks = particle.landmarks.deepCopy();
}

std::size_t FastSlam::landmarkBytes() const {
  std::unordered_set<const void*> seen;
  std::size_t sum = 0;
  for (const Particle& particle : particles_) sum += particle.landmarks.bytes(seen);
  return sum;
}

LandmarkFilterFactory fastSlamFactory(const FastSlamParameters& parameters,
                                      FeatureMatchers matchers) {
  return [parameters, matchers = std::move(matchers)] {
    return std::make_unique<FastSlam>(parameters, matchers);
  };
}

FilterEntry fastSlamEntry() {
  return {"Motion and features in, pose and landmarks out (docs/fast_slam.md).",
          [](ram_parameters::ParameterReader& reader, FeatureMatchers matchers) {
            return fastSlamFactory(readFastSlamParameters(reader), std::move(matchers));
          },
          FastSlamParameters::table().rows()};
}

}  // namespace ram_slam
