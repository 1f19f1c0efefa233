// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/map_drift.hpp"

namespace ram_slam {
namespace {

/// d pose / d motion about the origin.
Eigen::Matrix3d byMotion(const Pose2& pose) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -pose.y_m;
  jacobian(1, 2) = pose.x_m;
  return jacobian;
}

/// The covariance of the motion about the origin that gives the pose this covariance.
Eigen::Matrix3d aboutOrigin(const PoseWithCovariance2& pose) {
  const Eigen::Matrix3d inverse =
      byMotion({-pose.pose.x_m, -pose.pose.y_m, 0.0});  // of byMotion(pose.pose)
  return inverse * pose.covariance * inverse.transpose();
}

}  // namespace

double MapDrift::sizeOf(const Eigen::Matrix3d& covariance) const {
  return covariance(0, 0) + covariance(1, 1) + yaw_arm_m_ * yaw_arm_m_ * covariance(2, 2);
}

void MapDrift::reset(const PoseWithCovariance2& map_from_base) {
  covariance_ = aboutOrigin(map_from_base);
}

void MapDrift::move(const Pose2& map_from_base, const PoseWithCovariance2& motion) {
  covariance_ += aboutOrigin(PoseWithCovariance2{map_from_base, Eigen::Matrix3d::Zero()} * motion);
}

void MapDrift::fallBack(const Eigen::Matrix3d& before, const PoseWithCovariance2& seen) {
  const Eigen::Matrix3d covariance = before + aboutOrigin(seen);
  const Eigen::Matrix3d by_motion = byMotion(seen.pose);
  if (sizeOf(by_motion * covariance * by_motion.transpose()) < sizeOf(at(seen.pose)))
    covariance_ = covariance;
}

Eigen::Matrix3d MapDrift::bridged(const Eigen::Matrix3d& drift,
                                  const MapDrift& open,
                                  const Eigen::Vector2d& place_m) const {
  const Eigen::Matrix3d by_motion = byMotion({place_m.x(), place_m.y(), 0.0});
  const auto sizeHere = [this, &by_motion](const Eigen::Matrix3d& covariance) {
    return sizeOf(by_motion * covariance * by_motion.transpose());
  };
  const double closed = sizeHere(covariance_);
  const double length = sizeHere(open.covariance_) - closed;
  if (!(length > 0.0)) return drift;
  const double share = (sizeHere(drift) - closed) / length;
  if (!(share > 0.0 && share <= 1.0)) return drift;
  return covariance_ + (1.0 - share) * (drift - covariance_);
}

void MapDrift::cover(const PoseWithCovariance2& map_from_base) {
  if (sizeOf(at(map_from_base.pose)) < sizeOf(map_from_base.covariance)) reset(map_from_base);
}

Eigen::Matrix3d MapDrift::at(const Pose2& map_from_base) const {
  const Eigen::Matrix3d by_motion = byMotion(map_from_base);
  return by_motion * covariance_ * by_motion.transpose();
}

}  // namespace ram_slam
