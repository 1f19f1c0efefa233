// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// How far the part of the map around the robot may be off as a whole, seen from the start.
///
/// Particles that survive share their past, so that their spread shows how well the pose is known
/// relative to the landmarks nearby, not how well these are known. What is missing is kept here:
/// the covariance of a rigid motion of the map's part, written as that motion's (x, y, yaw) about
/// the map's origin. It grows with the odometry and falls back when landmarks are seen that were
/// created when it was smaller, to what it was then plus the pose's own covariance. Nothing is
/// averaged over landmarks, as their errors are alike.
class MapDrift {
public:
  /// \param yaw_arm_m  distance at which yaw counts as much as position where drifts are compared
  explicit MapDrift(double yaw_arm_m) : yaw_arm_m_(yaw_arm_m) {}

  /// Where the map begins, or the pose is set.
  void reset(const PoseWithCovariance2& map_from_base);
  /// \param map_from_base  where the motion began
  void move(const Pose2& map_from_base, const PoseWithCovariance2& motion);
  /// The robot sees landmarks created when the drift was `before`; `seen` is its pose relative to
  /// them. No effect if that is less certain than what is known.
  void fallBack(const Eigen::Matrix3d& before, const PoseWithCovariance2& seen);
  /// What follows from a closed loop for a part of the map that was learned in between, with
  /// `drift` then: the farther along between both ends, the more of it is gone (a Brownian bridge).
  /// The drift itself if no loop was closed. \param open  the drift before the loop was closed
  Eigen::Matrix3d bridged(const Eigen::Matrix3d& drift,
                          const MapDrift& open,
                          const Eigen::Vector2d& place_m) const;
  /// Never less than the covariance of this pose.
  void cover(const PoseWithCovariance2& map_from_base);

  /// Of the motion about the map's origin.
  const Eigen::Matrix3d& covariance() const { return covariance_; }
  /// Of a pose of the robot there, in x, y and yaw of the map frame.
  Eigen::Matrix3d at(const Pose2& map_from_base) const;

private:
  double sizeOf(const Eigen::Matrix3d& covariance) const;

  double yaw_arm_m_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

}  // namespace ram_slam
