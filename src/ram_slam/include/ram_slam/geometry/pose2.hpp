// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace ram_slam {

/// The same angle in (-pi, pi].
double wrapAngle(double angle_rad);

/// No coordinate of a map or an odometry is greater: the size of a zone of UTM, or of a country.
/// What claims to be farther off is damaged, and would only spoil what is computed from it.
constexpr double kFarthest_m = 1e7;

/// A pose in the plane, or equally the transform from one planar frame to another: SE(2).
///
/// Named `target_from_source`, so that `map_from_base * base_from_laser * point_in_laser` reads
/// like dominoes.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  Eigen::Vector2d translation() const { return {x_m, y_m}; }
  Eigen::Matrix2d rotation() const { return Eigen::Rotation2Dd(yaw_rad).toRotationMatrix(); }
  /// diag(R(yaw), 1): turns (x, y, yaw), and R M R^T a covariance or information M of these, from
  /// this frame's axes into those of the frame that the pose is seen from.
  Eigen::Matrix3d axesRotation() const {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() = rotation();
    return turn;
  }
  Pose2 inverse() const;
  bool isFinite() const {
    return std::isfinite(x_m) && std::isfinite(y_m) && std::isfinite(yaw_rad);
  }
  /// Finite, and not farther off than kFarthest_m on any axis.
  bool isUsable() const {
    return isFinite() && std::abs(x_m) <= kFarthest_m && std::abs(y_m) <= kFarthest_m;
  }
};

/// Composition; the yaw of the result is in (-pi, pi].
Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c);

/// The point of frame b, seen from frame a.
Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& point_in_b);

/// A pose at an instant, e.g. of the robot's base in the map: an element of a trajectory.
struct StampedPose2 {
  std::int64_t stamp_ns = 0;
  Pose2 pose;
};

/// a - b in x, y and yaw, in the axes of their common frame; the yaw in (-pi, pi].
Eigen::Vector3d componentDifference(const Pose2& a, const Pose2& b);

/// The pose reached by moving for unit time at a constant twist (x [m], y [m], yaw [rad]) from the
/// origin.
///
/// Exponential map of SE(2): t = V(yaw) (x, y), V = [[s, -c], [c, s]], s = sin(yaw) / yaw, c = (1 -
/// cos(yaw)) / yaw.
Pose2 exponential(const Eigen::Vector3d& twist);

/// The twist whose exponential is `pose`; inverse of exponential() for yaw in (-pi, pi).
Eigen::Vector3d logarithm(const Pose2& pose);

/// The pose a fraction of the way from `a` (0) to `b` (1) at constant twist; a fraction outside [0,
/// 1] extrapolates.
Pose2 interpolate(const Pose2& a, const Pose2& b, double fraction);

/// A motion carried on at its twist: what moved by `motion` within `interval_ns` moves by this
/// within `duration_ns`. The identity if the interval is not positive or longer than 1 s: its mean
/// twist is then no information about the next instants.
Pose2 continued(const Pose2& motion, std::int64_t interval_ns, std::int64_t duration_ns);

/// A pose with uncertainty. The covariance's order is x, y, yaw [m^2, m rad, rad^2], in the axes of
/// the pose's parent frame: covariance of (x_m, y_m, yaw_rad) themselves, as
/// geometry_msgs/PoseWithCovariance has it.
struct PoseWithCovariance2 {
  Pose2 pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Composition of two independent uncertain transforms, to first order:
/// cov = F cov_a F^T + G cov_b G^T, F = [[1, 0, -(y - y_a)], [0, 1, x - x_a], [0, 0, 1]], G =
/// diag(R(yaw_a), 1).
PoseWithCovariance2 operator*(const PoseWithCovariance2& a_from_b,
                              const PoseWithCovariance2& b_from_c);

}  // namespace ram_slam
