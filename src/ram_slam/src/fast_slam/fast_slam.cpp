// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/fast_slam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "ram_slam/fast_slam/map_summary.hpp"
#include "ram_slam/fast_slam/resampling.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {
namespace {

constexpr double kMemory = 0.95;  // of the running means of quality, per list
constexpr double kSymmetryTolerance = 1e-9;
// Landmarks younger than those of a map from a file may have been known to others.
constexpr LandmarkId kSkippedIds = 10000;
// Orientations: of things as they are, beyond what detectors state; share that is plainly wrong.
constexpr double kOrientationSigma_rad = 0.07;
constexpr double kWrongOrientations = 0.001;

void requireGood(const Feature& feature) {
  const Eigen::Matrix2d& c = feature.covariance_m2;
  const bool finite = feature.position_m.allFinite() && c.allFinite();
  if (!finite || std::abs(c(0, 1) - c(1, 0)) > kSymmetryTolerance * c.trace() || !(c(0, 0) > 0.0) ||
      !(c.determinant() > 0.0)) {
    throw std::invalid_argument(
        "a feature's position and covariance must be finite, the covariance symmetric and positive "
        "definite");
  }
}

void requireGood(const PoseWithCovariance2& pose) {
  const Eigen::Matrix3d& c = pose.covariance;
  if (!pose.pose.isFinite() || !c.allFinite()) {
    throw std::invalid_argument("an initial pose and its covariance must be finite");
  }
  const double tolerance = kSymmetryTolerance * (1.0 + c.norm());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(c, Eigen::EigenvaluesOnly);
  if ((c - c.transpose()).norm() > tolerance || solver.eigenvalues().minCoeff() < -tolerance) {
    throw std::invalid_argument(
        "the covariance of an initial pose must be symmetric positive semi-definite");
  }
}

Pose2 draw(const PoseWithCovariance2& from, Random random) {
  if (from.covariance.isZero(0.0)) return from.pose;
  const Eigen::Vector3d noise = random.gaussian(from.covariance);
  return {from.pose.x_m + noise.x(), from.pose.y_m + noise.y(),
          wrapAngle(from.pose.yaw_rad + noise.z())};
}

double orientationEvidence(const LandmarkRecord& record,
                           const Feature& feature,
                           const PoseWithCovariance2& map_from_base) {
  const double variance_rad2 = record.orientation_variance_rad2 +
                               feature.orientation_variance_rad2 + map_from_base.covariance(2, 2) +
                               kOrientationSigma_rad * kOrientationSigma_rad;
  return orientationLogRatio(
      map_from_base.pose.yaw_rad + feature.orientation_rad - record.orientation_rad, variance_rad2,
      kWrongOrientations);
}

std::size_t largest(const std::vector<double>& weights) {
  return static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) -
                                  weights.begin());
}

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, wrapAngle(a.yaw_rad - b.yaw_rad)};
}

}  // namespace

FastSlam::FastSlam(const FastSlamParameters& parameters,
                   FeatureMatchers matchers,
                   const PoseWithCovariance2& map_from_base)
    : parameters_(parameters), matchers_(std::move(matchers)) {
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
    particles_[i].map_from_base =
        draw(map_from_base, Random(parameters_.seed, update_count_, 2 * particles_.size() + i));
  }
  best_ = 0;
  estimate_ = map_from_base;
  drift_.reset(map_from_base);
  since_learning_ = {};
}

void FastSlam::setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) {
  if (stamp_ns <= 0 || stamp_ns < stamp_ns_) {
    throw std::invalid_argument("a pose of " + std::to_string(stamp_ns) +
                                " ns is older than the filter, of " + std::to_string(stamp_ns_) +
                                " ns");
  }
  setPose(map_from_base);
  stamp_ns_ = stamp_ns;
}

void FastSlam::setMap(const LandmarkMap& map, const std::vector<StampedPose2>& path) {
  validate(path);
  LandmarkRegistry registry;
  LandmarkTree landmarks;
  for (const LandmarkEstimate& estimate : map.landmarks) {
    Feature feature;
    feature.position_m = estimate.mean_m;
    feature.covariance_m2 = estimate.covariance_m2;
    requireGood(feature);
    LandmarkRecord record;
    record.id = estimate.id;
    record.type = estimate.type;
    record.classifier = std::make_shared<const std::string>(estimate.classifier);
    const DescriptorPointer appearance =
        parseDescriptor(matchers_, record.type, estimate.classifier);
    if (appearance != nullptr) record.descriptors.push_back(appearance);
    record.existence_log_odds = std::clamp(estimate.existence_log_odds, parameters_.delete_log_odds,
                                           parameters_.maximum_log_odds);
    record.was_confirmed = record.existence_log_odds >= parameters_.confirm_log_odds;
    record.orientation_rad = estimate.orientation_rad;
    record.orientation_variance_rad2 = estimate.orientation_variance_rad2;
    record.placed_ns = estimate.placed_ns;
    registry.restore(std::move(record));
    landmarks.set(estimate.id, {estimate.mean_m, estimate.covariance_m2});
  }
  registry.skip(kSkippedIds);
  Path driven;
  for (const StampedPose2& pose : path) driven.append(pose);
  registry_ = std::move(registry);
  shared_error_.forget();
  for (Particle& particle : particles_) {
    particle.landmarks = landmarks;
    particle.path = driven;
  }
  for (LandmarkRecord& record : registry_.records()) refreshBounds(record);
}

void FastSlam::check(const FeatureList& list) const {
  for (const Feature& feature : list.features) requireGood(feature);
  if (list.stamp_ns <= 0 || list.stamp_ns < stamp_ns_) {
    throw std::invalid_argument("features of " + std::to_string(list.stamp_ns) +
                                " ns are older than those before, of " + std::to_string(stamp_ns_) +
                                " ns");
  }
}

void FastSlam::update(const FeatureList& list, const MotionModel& model, const FieldOfView* view) {
  check(list);
  update(list, motionStep(model, stamp_ns_, list.stamp_ns), view);
}

void FastSlam::update(const FeatureList& list, const MotionStep& step, const FieldOfView* view) {
  check(list);
  const std::vector<DescriptorPointer> descriptors = describe(list);
  const Step moved = prepare(step);
  // From here on nothing fails.
  const bool learns = isDue(list, moved);
  stamp_ns_ = list.stamp_ns;
  ++update_count_;
  since_learning_ = moved.motion;
  PoseWithCovariance2 drifted = moved.since_list;
  drifted.covariance *= parameters_.drift_inflation;
  drift_.move(estimate_.pose, drifted);
  move(moved);
  const std::vector<Observation> observations = observe(list, descriptors);
  const std::vector<Evidence> evidence = weigh(observations);
  if (parameters_.mode == FastSlamMode::kFastSlam2)
    coverErrors(moved.since_list.pose.translation().norm());
  if (learns) {
    learned_ns_ = stamp_ns_;
    since_learning_ = {};
    drawPoses(evidence);
    updateMaps(list, descriptors, observations, evidence);
    collectEvidence(view);
    resample();
  }
}

bool FastSlam::isDue(const FeatureList& list, const Step& step) const {
  if (parameters_.mode == FastSlamMode::kFastSlam1 || learned_ns_ == 0) return true;
  const Pose2& moved = step.motion.pose;
  return !list.features.empty() && (list.stamp_ns == learned_ns_ ||
                                    moved.translation().norm() >= parameters_.update_distance ||
                                    std::abs(moved.yaw_rad) >= parameters_.update_angle);
}

std::vector<DescriptorPointer> FastSlam::describe(const FeatureList& list) const {
  std::vector<DescriptorPointer> descriptors;
  descriptors.reserve(list.features.size());
  for (const Feature& feature : list.features)
    descriptors.push_back(parseDescriptor(matchers_, feature.type, feature.classifier));
  return descriptors;
}

FastSlam::Step FastSlam::prepare(const MotionStep& step) const {
  Step result;
  result.motion = since_learning_;
  if (!started() || step.to_ns == stamp_ns_) return result;
  if (parameters_.mode == FastSlamMode::kFastSlam2) {
    result.since_list = step.motion;
    result.motion = since_learning_ * result.since_list;
    if (!result.motion.pose.isFinite() || !result.motion.covariance.allFinite()) {
      throw std::invalid_argument("the motion model gives a motion that is not finite");
    }
  } else {
    std::vector<Pose2> poses;
    for (const Particle& particle : particles_) poses.push_back(particle.map_from_base);
    result.map_from_base = step.model->sample(poses, stamp_ns_, step.to_ns,
                                              Random(parameters_.seed, update_count_ + 1)());
    const bool finite = std::all_of(result.map_from_base.begin(), result.map_from_base.end(),
                                    [](const Pose2& pose) { return pose.isFinite(); });
    if (result.map_from_base.size() != particles_.size() || !finite) {
      throw std::invalid_argument(
          "the motion model gives too few poses or some that are not finite");
    }
  }
  return result;
}

void FastSlam::move(const Step& step) {
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle& particle = particles_[i];
    if (step.map_from_base.empty()) {
      particle.proposal =
          PoseWithCovariance2{particle.map_from_base, Eigen::Matrix3d::Zero()} * step.motion;
    } else {
      particle.proposal = {step.map_from_base[i], Eigen::Matrix3d::Zero()};
    }
  }
}

std::vector<Observation> FastSlam::observe(
    const FeatureList& list, const std::vector<DescriptorPointer>& descriptors) const {
  const double gate = std::sqrt(parameters_.creation_gate);
  const Eigen::Matrix2d floor_m2 = parameters_.feature_noise_floor *
                                   parameters_.feature_noise_floor * Eigen::Matrix2d::Identity();
  std::vector<Observation> observations(list.features.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Feature& feature = list.features[i];
    observations[i].type = feature.type;
    observations[i].measured = {feature.position_m, feature.covariance_m2 + floor_m2};
    Eigen::AlignedBox2d places_m;
    double pose_variance_m2 = 0.0;
    for (const Particle& particle : particles_) {
      places_m.extend(particle.proposal.pose * feature.position_m);
      const Eigen::Matrix3d& c = particle.proposal.covariance;
      // Bounds the trace of H_x P H_x^T: the variance of position plus that of the lever arm,
      // doubled for their correlation.
      pose_variance_m2 = std::max(
          pose_variance_m2, 2.0 * (c(0, 0) + c(1, 1) + c(2, 2) * feature.position_m.squaredNorm()));
    }
    const double noise_m = std::sqrt(observations[i].measured.covariance_m2.trace());
    const double reach_m =
        std::max({gate * (noise_m + std::sqrt(pose_variance_m2)),
                  parameters_.minimum_feature_separation, parameters_.feature_match_distance});
    places_m.min().array() -= reach_m;
    places_m.max().array() += reach_m;
    for (const LandmarkRecord& record : registry_.records()) {
      if (!places_m.intersects(record.bounds_m) || record.type != feature.type) continue;
      const double by_appearance = logLikelihoodRatio(findMatcher(matchers_, feature.type),
                                                      descriptors[i], record.descriptors);
      const PoseWithCovariance2& pose = particles_[best_].proposal;
      observations[i].candidates.push_back(
          {record.id, record.existence_log_odds >= parameters_.confirm_log_odds,
           by_appearance + orientationEvidence(record, feature, pose)});
    }
  }
  return observations;
}

std::vector<Evidence> FastSlam::weigh(const std::vector<Observation>& observations) {
  const bool version2 = parameters_.mode == FastSlamMode::kFastSlam2;
  std::vector<Evidence> evidence;
  evidence.reserve(particles_.size());
  std::vector<double> log_weights;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle& particle = particles_[i];
    evidence.push_back(
        version2 ? associate(observations, particle.landmarks, particle.proposal, parameters_,
                             Random(parameters_.seed, update_count_, 3 * particles_.size() + i))
                 : associateByDistance(observations, particle.landmarks, particle.proposal.pose,
                                       parameters_));
    particle.proposal = evidence.back().map_from_base;
    particle.path.append({stamp_ns_, particle.proposal.pose});
    log_weights.push_back(particle.log_weight +
                          parameters_.evidence_exponent * evidence.back().log_likelihood_ratio);
  }
  const std::vector<double> weights = normalisedWeights(log_weights);
  updateEstimate(weights);
  quality_.effective_fraction = effectiveCount(weights) / static_cast<double>(weights.size());
  rate(evidence[largest(weights)]);
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

void FastSlam::drawPoses(const std::vector<Evidence>& evidence) {
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle& particle = particles_[i];
    particle.log_weight += parameters_.evidence_exponent * evidence[i].log_likelihood_ratio;
    particle.map_from_base = draw(particle.proposal, Random(parameters_.seed, update_count_, i));
    particle.path.append({stamp_ns_, particle.map_from_base});
  }
  const std::vector<double> weights = this->weights();
  best_ = largest(weights);
  // Relative to the best, so that they stay in range.
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    particles_[i].log_weight = std::log(weights[i] / weights[best_]);
  }
}

std::vector<double> FastSlam::weights() const {
  std::vector<double> log_weights;
  log_weights.reserve(particles_.size());
  for (const Particle& particle : particles_) log_weights.push_back(particle.log_weight);
  return normalisedWeights(log_weights);
}

void FastSlam::updateEstimate(const std::vector<double>& weights) {
  const Pose2& reference = particles_[largest(weights)].proposal.pose;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    mean += weights[i] * difference(particles_[i].proposal.pose, reference);
  }
  estimate_.pose = {reference.x_m + mean.x(), reference.y_m + mean.y(),
                    wrapAngle(reference.yaw_rad + mean.z())};
  Eigen::Matrix3d within = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d between = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const Eigen::Vector3d deviation = difference(particles_[i].proposal.pose, estimate_.pose);
    within += weights[i] * particles_[i].proposal.covariance;
    between += weights[i] * deviation * deviation.transpose();
  }
  // A sample's own mean is nearer to it than the true mean is: the weighted form of n / (n - 1).
  const double effective = effectiveCount(weights);
  if (effective > 1.0 + 1e-9) between *= effective / (effective - 1.0);
  estimate_.covariance = within + between;
}

void FastSlam::rate(const Evidence& evidence) {
  associations_ = evidence.associations;
  quality_.matched_count = quality_.new_count = quality_.ignored_count = 0;
  for (const Association& association : evidence.associations) {
    if (association.outcome == AssociationOutcome::kMatched) ++quality_.matched_count;
    if (association.outcome == AssociationOutcome::kNew) ++quality_.new_count;
    if (association.outcome == AssociationOutcome::kIgnored) ++quality_.ignored_count;
  }
  if (evidence.associations.empty()) return;
  const double matched = quality_.matched_count / static_cast<double>(evidence.associations.size());
  quality_.matched_fraction += (1.0 - kMemory) * (matched - quality_.matched_fraction);
  if (evidence.correction_count == 0) return;
  const double innovation = evidence.squared_mahalanobis / (2.0 * evidence.correction_count);
  quality_.normalised_innovation += (1.0 - kMemory) * (innovation - quality_.normalised_innovation);
}

LandmarkMap FastSlam::landmarks() const {
  LandmarkMap map = summarise(registry_, particles_[best_], particles_, weights());
  map.stamp_ns = stamp_ns_;
  return map;
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

}  // namespace ram_slam
