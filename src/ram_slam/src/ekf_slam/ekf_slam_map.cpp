// SPDX-License-Identifier: BSD-3-Clause
// What changes pose or map other than by features.
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "ram_slam/ekf_slam/ekf_slam.hpp"
#include "ram_slam/fast_slam/map_summary.hpp"
#include "ram_slam/fast_slam/trajectory_correction.hpp"

namespace ram_slam {
namespace {

/// Wendland's function of the smoothness that keeps a plane's covariances positive definite: 1 at
/// 0, 0 from 1 on.
double taper(double distance) {
  return distance >= 1.0 ? 0.0 : std::pow(1.0 - distance, 4) * (1.0 + 4.0 * distance);
}

/// Joint covariance of the landmarks' coordinates, or without what is stated between them if that
/// were not positive definite.
Eigen::MatrixXd jointCovariance(const LandmarkMap& map) {
  const auto size = 2 * static_cast<Eigen::Index>(map.landmarks.size());
  Eigen::MatrixXd separate = Eigen::MatrixXd::Zero(size, size);
  std::map<LandmarkId, Eigen::Index> rows;
  for (const LandmarkEstimate& landmark : map.landmarks) {
    const auto row = 2 * static_cast<Eigen::Index>(rows.size());
    rows[landmark.id] = row;
    separate.block<2, 2>(row, row) = landmark.covariance_m2;
  }
  Eigen::MatrixXd joint = separate;
  for (const LandmarkCovariance& between : map.covariances) {
    const auto first = rows.find(between.first_id);
    const auto second = rows.find(between.second_id);
    if (first == rows.end() || second == rows.end()) continue;
    joint.block<2, 2>(first->second, second->second) = between.covariance_m2;
    joint.block<2, 2>(second->second, first->second) = between.covariance_m2.transpose();
  }
  return joint.llt().info() == Eigen::Success ? joint : separate;
}

}  // namespace

void EkfSlam::setPose(const PoseWithCovariance2& map_from_base) {
  requireGood(map_from_base);
  belief_.setPose(map_from_base);
  publish();
  hypothesis().proposal = map_from_base;
  estimate_ = map_from_base;
  since_update_ = {};
}

void EkfSlam::setPose(const PoseWithCovariance2& map_from_base, std::int64_t stamp_ns) {
  requireNotOlder(stamp_ns, stamp_ns_);
  setPose(map_from_base);
  stamp_ns_ = stamp_ns;
}

void EkfSlam::movePose(const Pose2& new_from_old) {
  const PoseWithCovariance2 move{new_from_old, Eigen::Matrix3d::Zero()};
  belief_.movePose(new_from_old);
  hypothesis().map_from_base = belief_.pose();
  hypothesis().proposal = move * hypothesis().proposal;
  hypothesis().path.moveLast(new_from_old);
  estimate_ = move * estimate_;
}

void EkfSlam::setMap(const LandmarkMap& map, const Trajectory& path) {
  validate(path);
  LandmarkRegistry registry;
  std::vector<Eigen::Vector2d> points_m;
  for (const LandmarkEstimate& estimate : map.landmarks) {
    registry.restore(recordOf(estimate, matchers_, common()));
    points_m.push_back(estimate.mean_m);
  }
  registry.skip(static_cast<LandmarkId>(common().skipped_ids));
  JointBelief belief(belief_.poseWithCovariance());
  if (!points_m.empty()) belief.add(points_m, jointCovariance(map));
  belief_ = std::move(belief);
  registry_ = std::move(registry);
  shared_error_.forget();
  is_map_loaded_ = path.empty();
  hypothesis().landmarks = {};
  hypothesis().path = {};
  for (const StampedPose2& pose : path) hypothesis().path.append(pose);
  publish();
}

Pose2 EkfSlam::followTrajectory(const Trajectory& corrected) {
  validate(corrected);
  if (!started() || corrected.empty())
    throw std::invalid_argument("there is no path that could be corrected");
  std::optional<MotionGate> loaded_frame;
  if (is_map_loaded_) loaded_frame = common().loaded_frame;
  const TrajectoryCorrection correction(trajectory(), corrected, loaded_frame);

  // From here on nothing fails.
  std::vector<Pose2> new_from_old;
  for (const LandmarkRecord& record : registry_.records())
    new_from_old.push_back(correction.ofLandmark(record));
  belief_.movePoints(new_from_old);
  movePose(correction.newFromOld(stamp_ns_));
  hypothesis().path = correction.correctedPath();
  shared_error_.follow(correction.inMap(corrected));
  publish();
  const auto apart = [this](LandmarkId younger, LandmarkId older) {
    return belief_.differenceCovariance(indexOf(younger), indexOf(older));
  };
  remove(duplicates(registry_, best().landmarks, apart, matchers_, common()));
  return correction.mapFromCorrected();
}

LandmarkMap EkfSlam::landmarks() const {
  LandmarkMap map = summarise(registry_, best(), hypotheses_, {1.0}, common().summary);
  map.stamp_ns = stamp_ns_;
  const double range_m = common().summary.pair_distance_m;
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const LandmarkEstimate& first = map.landmarks[i];
    for (std::size_t j = i + 1; j < map.landmarks.size(); ++j) {
      const LandmarkEstimate& second = map.landmarks[j];
      const double distance_m = (first.mean_m - second.mean_m).norm();
      if (!(distance_m < range_m)) continue;
      map.covariances.push_back(
          {first.id, second.id,
           taper(distance_m / range_m) *
               belief_.crossCovariance(indexOf(first.id), indexOf(second.id))});
    }
  }
  return map;
}

}  // namespace ram_slam
