// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ukf_localiser/ukf_localiser.hpp"

#include <algorithm>
#include <stdexcept>

#include "ram_slam/fast_slam/association_candidates.hpp"
#include "ram_slam/fast_slam/read_filter_parameters.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/ukf_localiser/sigma_points.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<UkfLocaliserParameters>& UkfLocaliserParameters::table() {
  using P = UkfLocaliserParameters;
  static const auto table =
      ram_parameters::ParameterTable<P>().include(&P::common, FastSlamParameters::landmarkTable());
  return table;
}

UkfLocaliser::UkfLocaliser(const UkfLocaliserParameters& parameters, FeatureMatchers matchers)
    : parameters_((parameters.validate(), parameters)),
      matchers_(std::move(matchers)),
      shared_error_(parameters.common.shared_error) {
  shared_error_.forget();
}

PoseWithCovariance2 UkfLocaliser::predicted(const MotionStep& step) const {
  if (!started() || step.to_ns == stamp_ns_) return pose_;
  std::vector<Pose2> points = sigmaPoints(pose_);
  if (step.model != nullptr) {
    points = step.model->predictEach(points, stamp_ns_, step.to_ns);
  } else {
    for (Pose2& point : points) point = point * step.motion.pose;
  }
  PoseWithCovariance2 moved = momentsOf(points);
  const Eigen::Matrix3d axes = pose_.pose.axesRotation();
  moved.covariance += axes * step.motion.covariance * axes.transpose();
  if (!moved.pose.isFinite() || !moved.covariance.allFinite())
    throw std::invalid_argument("the motion model gives a motion that is not finite");
  return moved;
}

void UkfLocaliser::update(const FeatureList& list, const MotionStep& step, const FieldOfView*) {
  check(list);
  if (registry_.records().empty()) {
    throw std::invalid_argument(
        "ukf_localiser has no map: give it one with landmarks (initial_map), or take an estimator "
        "that makes one");
  }
  const FastSlamParameters& common = parameters_.common;
  const std::vector<DescriptorPointer> descriptors = describe(list, matchers_);
  const PoseWithCovariance2 moved = predicted(step);
  // From here on nothing fails.
  since_update_ = since_update_ * (pose_.pose.inverse() * moved.pose);
  const bool is_update_due =
      updated_ns_ == 0 ||
      (!list.features.empty() &&
       (list.stamp_ns == updated_ns_ ||
        MotionGate{common.update_distance, common.update_angle}.isReachedBy(since_update_)));
  stamp_ns_ = list.stamp_ns;
  pose_ = moved;
  hypothesis().proposal = moved;
  const std::vector<Observation> observations =
      AssociationCandidates(common, matchers_, registry_, hypotheses_, 0)
          .observe(list, descriptors);
  const Evidence evidence = associateCertain(observations, best().landmarks, moved, common);
  associations_ = evidence.associations;
  quality_.add(evidence, common.quality_memory);
  const PoseWithCovariance2 now = corrected(observations, evidence.associations);
  hypothesis().proposal = now;
  hypothesis().path.append({stamp_ns_, now.pose}, common.path.step);
  limitPaths(hypotheses_, 0, static_cast<std::size_t>(common.path.max_poses));
  estimate_ = now;
  estimate_.covariance += shared_error_.covariance(common.pose_noise_floor);
  if (!is_update_due) return;
  updated_ns_ = stamp_ns_;
  since_update_ = {};
  pose_ = now;
  hypothesis().map_from_base = now.pose;
}

PoseWithCovariance2 UkfLocaliser::corrected(const std::vector<Observation>& observations,
                                            const std::vector<Association>& associations) const {
  std::vector<LandmarkId> ids;
  std::vector<MapSighting> sightings;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const LandmarkId id = associations[i].id;
    if (associations[i].outcome != AssociationOutcome::kMatched ||
        registry_.find(id)->existence_log_odds < confirm_log_odds())
      continue;
    ids.push_back(id);
    sightings.push_back({*best().landmarks.find(id), observations[i].measured});
  }
  const auto size = 2 * static_cast<Eigen::Index>(ids.size());
  Eigen::MatrixXd cross_m2 = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t a = 0; a < ids.size(); ++a) {
    for (std::size_t b = 0; b < ids.size(); ++b) {
      const auto found = between_m2_.find({ids[a], ids[b]});
      if (found == between_m2_.end()) continue;
      const Eigen::Index row = 2 * static_cast<Eigen::Index>(a);
      const Eigen::Index column = 2 * static_cast<Eigen::Index>(b);
      cross_m2.block<2, 2>(row, column) = found->second;
      cross_m2.block<2, 2>(column, row) = found->second.transpose();
    }
  }
  return correctedBy(pose_, sightings, cross_m2);
}

LandmarkMap UkfLocaliser::landmarks() const {
  LandmarkMap map = map_;
  map.stamp_ns = stamp_ns_;
  return map;
}

std::vector<Pose2> UkfLocaliser::hypotheses() const {
  return sigmaPoints(best().proposal);
}

std::vector<std::pair<std::string, double>> UkfLocaliser::health() const {
  return {{"features matched recently", quality_.matched_fraction},
          {"normalised innovation", quality_.normalised_innovation}};
}

void UkfLocaliser::setPose(const PoseWithCovariance2& map_from_base) {
  requireGood(map_from_base);
  pose_ = estimate_ = hypothesis().proposal = map_from_base;
  hypothesis().map_from_base = map_from_base.pose;
  since_update_ = {};
}

void UkfLocaliser::setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) {
  requireNotOlder(stamp_ns, stamp_ns_);
  setPose(map_from_base);
  stamp_ns_ = stamp_ns;
}

void UkfLocaliser::movePose(const Pose2& new_from_old) {
  const PoseWithCovariance2 move{new_from_old, Eigen::Matrix3d::Zero()};
  pose_ = move * pose_;
  estimate_ = move * estimate_;
  hypothesis().proposal = move * hypothesis().proposal;
  hypothesis().map_from_base = new_from_old * hypothesis().map_from_base;
  hypothesis().path.moveLast(new_from_old);
}

void UkfLocaliser::setMap(const LandmarkMap& map, const Trajectory& path) {
  validate(path);
  LandmarkRegistry registry;
  Particle particle = best();
  particle.landmarks = {};
  particle.path = {};
  for (const StampedPose2& pose : path) particle.path.append(pose);
  for (const LandmarkEstimate& estimate : map.landmarks) {
    LandmarkRecord record = recordOf(estimate, matchers_, parameters_.common);
    record.bounds_m =
        boundsOf(estimate.mean_m, estimate.covariance_m2, parameters_.common.creation_gate);
    registry.restore(std::move(record));
    particle.landmarks.set(estimate.id, {estimate.mean_m, estimate.covariance_m2});
  }
  between_m2_.clear();
  for (const LandmarkCovariance& between : map.covariances)
    between_m2_[{between.first_id, between.second_id}] = between.covariance_m2;
  map_ = map;
  registry_ = std::move(registry);
  hypothesis() = std::move(particle);
}

Pose2 UkfLocaliser::followTrajectory(const Trajectory& /*corrected*/) {
  throw std::invalid_argument("ukf_localiser keeps the map that it was given");
}

FilterEntry ukfLocaliserEntry() {
  return {"The estimator ukf_localiser: the pose in a given map (docs/ukf_localiser.md).",
          [](ram_parameters::ParameterReader& reader,
             const FeatureMatchers& matchers) -> LandmarkFilterFactory {
            return [parameters = readFilterParameters<UkfLocaliserParameters>(reader), matchers] {
              return std::make_unique<UkfLocaliser>(parameters, matchers);
            };
          },
          UkfLocaliserParameters::table().rows()};
}

}  // namespace ram_slam
