// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {
namespace {

/// Speed changes within a longer time: the mean of such an interval is not the speed at its end.
constexpr std::int64_t kLongestContinuedNs = 1'000'000'000;

/// sin(x) / x and (1 - cos(x)) / x, by their series where the quotient loses digits.
struct ExponentialFactors {
  explicit ExponentialFactors(double x) {
    if (std::abs(x) < 1e-4) {
      s = 1.0 - x * x / 6.0;
      c = x / 2.0;
    } else {
      s = std::sin(x) / x;
      c = (1.0 - std::cos(x)) / x;
    }
  }
  double s;
  double c;
};

}  // namespace

double wrapAngle(double angle_rad) {
  if (angle_rad > -M_PI && angle_rad <= M_PI) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2.0 * M_PI);
  return wrapped <= -M_PI ? wrapped + 2.0 * M_PI : wrapped;
}

Pose2 Pose2::inverse() const {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {-c * x_m - s * y_m, s * x_m - c * y_m, wrapAngle(-yaw_rad)};
}

Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c) {
  const double c = std::cos(a_from_b.yaw_rad);
  const double s = std::sin(a_from_b.yaw_rad);
  return {a_from_b.x_m + c * b_from_c.x_m - s * b_from_c.y_m,
          a_from_b.y_m + s * b_from_c.x_m + c * b_from_c.y_m,
          wrapAngle(a_from_b.yaw_rad + b_from_c.yaw_rad)};
}

Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& point_in_b) {
  const double c = std::cos(a_from_b.yaw_rad);
  const double s = std::sin(a_from_b.yaw_rad);
  return {a_from_b.x_m + c * point_in_b.x() - s * point_in_b.y(),
          a_from_b.y_m + s * point_in_b.x() + c * point_in_b.y()};
}

Eigen::Vector3d componentDifference(const Pose2& a, const Pose2& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, wrapAngle(a.yaw_rad - b.yaw_rad)};
}

Pose2 exponential(const Eigen::Vector3d& twist) {
  const ExponentialFactors v(twist.z());
  return {v.s * twist.x() - v.c * twist.y(), v.c * twist.x() + v.s * twist.y(),
          wrapAngle(twist.z())};
}

Eigen::Vector3d logarithm(const Pose2& pose) {
  const double yaw_rad = wrapAngle(pose.yaw_rad);
  const ExponentialFactors v(yaw_rad);
  const double determinant = v.s * v.s + v.c * v.c;
  return {(v.s * pose.x_m + v.c * pose.y_m) / determinant,
          (-v.c * pose.x_m + v.s * pose.y_m) / determinant, yaw_rad};
}

Pose2 interpolate(const Pose2& a, const Pose2& b, double fraction) {
  return a * exponential(fraction * logarithm(a.inverse() * b));
}

Pose2 continued(const Pose2& motion, std::int64_t interval_ns, std::int64_t duration_ns) {
  if (interval_ns <= 0 || interval_ns > kLongestContinuedNs || duration_ns == 0) return {};
  const double share = static_cast<double>(duration_ns) / static_cast<double>(interval_ns);
  return exponential(share * logarithm(motion));
}

PoseWithCovariance2 operator*(const PoseWithCovariance2& a_from_b,
                              const PoseWithCovariance2& b_from_c) {
  PoseWithCovariance2 result;
  result.pose = a_from_b.pose * b_from_c.pose;
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  f(0, 2) = -(result.pose.y_m - a_from_b.pose.y_m);
  f(1, 2) = result.pose.x_m - a_from_b.pose.x_m;
  const Eigen::Matrix3d g = a_from_b.pose.axesRotation();
  result.covariance =
      f * a_from_b.covariance * f.transpose() + g * b_from_c.covariance * g.transpose();
  return result;
}

}  // namespace ram_slam
