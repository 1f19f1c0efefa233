// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ekf_slam/ekf_slam.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ram_slam/fast_slam/association_candidates.hpp"
#include "ram_slam/fast_slam/associator.hpp"
#include "ram_slam/fast_slam/landmark_existence.hpp"
#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {
namespace {

/// The belief about the pose and the landmarks that the features of one reading may show.
class LocalBelief {
public:
  /// \param ids  of the landmarks of the belief, ascending
  LocalBelief(JointBelief belief, std::vector<LandmarkId> ids)
      : belief_(std::move(belief)), ids_(std::move(ids)) {}

  const Eigen::Vector2d* find(LandmarkId id) const { return &belief_.point_m(indexOf(id)); }
  Innovation innovation(LandmarkId id, const PointMeasurement& measured) const {
    return belief_.innovation({indexOf(id), measured});
  }
  void correct(const Innovation&, LandmarkId id, const PointMeasurement& measured) {
    belief_.correct({{indexOf(id), measured}});
  }
  PoseWithCovariance2 pose() const { return belief_.poseWithCovariance(); }

private:
  std::size_t indexOf(LandmarkId id) const {
    return static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }

  JointBelief belief_;
  std::vector<LandmarkId> ids_;
};

}  // namespace

EkfSlam::EkfSlam(const EkfSlamParameters& parameters,
                 FeatureMatchers matchers,
                 const PoseWithCovariance2& map_from_base)
    : parameters_((parameters.validate(), parameters)),
      matchers_(std::move(matchers)),
      shared_error_(parameters.common.shared_error) {
  setPose(map_from_base);
}

std::size_t EkfSlam::indexOf(LandmarkId id) const {
  return static_cast<std::size_t>(registry_.find(id) - registry_.records().data());
}

void EkfSlam::update(const FeatureList& list, const MotionStep& step, const FieldOfView* view) {
  check(list);
  const std::vector<DescriptorPointer> descriptors = describe(list, matchers_);
  PoseWithCovariance2 since_list;
  if (started() && step.to_ns != stamp_ns_) since_list = step.motion;
  const PoseWithCovariance2 since_update = since_update_ * since_list;
  if (!since_update.pose.isFinite() || !since_update.covariance.allFinite())
    throw std::invalid_argument("the motion model gives a motion that is not finite");
  // From here on nothing fails.
  const bool is_update_due =
      updated_ns_ == 0 || (!list.features.empty() &&
                           (list.stamp_ns == updated_ns_ ||
                            MotionGate{common().update_distance, common().update_angle}.isReachedBy(
                                since_update.pose)));
  stamp_ns_ = list.stamp_ns;
  since_update_ = since_update;
  // Relative to the pose at the last update, as the bounds of the landmarks are.
  hypothesis().proposal =
      PoseWithCovariance2{belief_.pose(), Eigen::Matrix3d::Zero()} * since_update;
  const std::vector<Observation> observations =
      AssociationCandidates(common(), matchers_, registry_, hypotheses_, 0)
          .observe(list, descriptors);
  const Evidence evidence = associate(observations, since_update);
  associations_ = evidence.associations;
  quality_.add(evidence, common().quality_memory);
  hypothesis().proposal = evidence.map_from_base;
  hypothesis().path.append({stamp_ns_, evidence.map_from_base.pose}, common().path.step);
  limitPaths(hypotheses_, 0, static_cast<std::size_t>(common().path.max_poses));
  estimate_ = evidence.map_from_base;
  shared_error_.move(since_list.pose.translation().norm(), estimate_.pose.translation());
  estimate_.covariance += shared_error_.covariance(common().pose_noise_floor);
  if (!is_update_due) return;
  updated_ns_ = stamp_ns_;
  since_update_ = {};
  if (is_map_fixed_) {
    belief_.setPose(evidence.map_from_base);
    publish();
    return;
  }
  belief_.move(since_update);
  updateMap(list, descriptors, observations, evidence);
  const LandmarkExistence existence(common(), hypotheses_, {1.0});
  remove(existence.update(registry_, view, estimate_.pose));
}

Evidence EkfSlam::associate(const std::vector<Observation>& observations,
                            const PoseWithCovariance2& since_update) const {
  std::vector<LandmarkId> ids;
  for (const Observation& observation : observations) {
    for (const AssociationCandidate& candidate : observation.candidates)
      ids.push_back(candidate.id);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<std::size_t> indices;
  for (const LandmarkId id : ids) indices.push_back(indexOf(id));
  JointBelief here = belief_.part(indices);
  here.move(since_update);
  Associator<LocalBelief> associator(observations, {std::move(here), std::move(ids)}, common());
  associator.passes();
  return associator.finish();
}

void EkfSlam::updateMap(const FeatureList& list,
                        const std::vector<DescriptorPointer>& descriptors,
                        const std::vector<Observation>& observations,
                        const Evidence& evidence) {
  std::vector<JointBelief::Sighting> sightings;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Association& association = evidence.associations[i];
    if (association.outcome != AssociationOutcome::kMatched) continue;
    LandmarkRecord& record = *registry_.find(association.id);
    record.matched_weight = 1.0;
    if (record.existence_log_odds >= common().confirm_log_odds)
      sightings.push_back({indexOf(association.id), observations[i].measured});
  }
  belief_.correct(sightings);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (evidence.associations[i].outcome != AssociationOutcome::kNew) continue;
    if (belief_.size() >= static_cast<std::size_t>(parameters_.max_landmarks)) {
      ++left_out_count_;
      continue;
    }
    LandmarkRecord& record = registry_.create(list.features[i], descriptors[i]);
    record.placed_ns = stamp_ns_;
    record.seen_within_m = list.features[i].position_m.norm();
    belief_.add(observations[i].measured);
  }
  publish();
  hypothesis().path.append({stamp_ns_, belief_.pose()}, common().path.step);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Association& association = evidence.associations[i];
    if (association.outcome == AssociationOutcome::kMatched)
      rememberSighting(*registry_.find(association.id), best(), {list.features[i], descriptors[i]},
                       matchers_, common().appearance);
  }
}

void EkfSlam::publish() {
  Particle& particle = hypothesis();
  particle.map_from_base = belief_.pose();
  for (std::size_t i = 0; i < belief_.size(); ++i) {
    LandmarkRecord& record = registry_.records()[i];
    particle.landmarks.set(record.id, belief_.landmark(i));
    // How far the whole map may be off does not matter to what the robot sees from there.
    record.bounds_m =
        boundsOf(belief_.point_m(i), belief_.covarianceFromPose(i), common().creation_gate);
  }
}

void EkfSlam::remove(const std::vector<LandmarkId>& ids) {
  std::vector<std::size_t> indices;
  for (const LandmarkId id : ids) indices.push_back(indexOf(id));
  belief_.remove(indices);
  for (const LandmarkId id : ids) {
    registry_.remove(id);
    hypothesis().landmarks.erase(id);
  }
}

std::vector<std::pair<std::string, double>> EkfSlam::health() const {
  return {{"features matched recently", quality_.matched_fraction},
          {"normalised innovation", quality_.normalised_innovation},
          {"features left out because of max_landmarks", left_out_count_}};
}

FilterEntry ekfSlamEntry() {
  return {
      "The estimator ekf_slam: one normal distribution over pose and landmarks "
      "(docs/ekf_slam.md).",
      [](ram_parameters::ParameterReader& reader,
         const FeatureMatchers& matchers) -> LandmarkFilterFactory {
        return [parameters = readEkfSlamParameters(reader), matchers] {
          return std::make_unique<EkfSlam>(parameters, matchers);
        };
      },
      EkfSlamParameters::table().rows()};
}

}  // namespace ram_slam
