// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/pose2.hpp"

#include <cmath>

namespace ramscout_sim {

double wrapAngle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * M_PI);
  return wrapped <= -M_PI ? wrapped + 2.0 * M_PI : wrapped;
}

Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c) {
  const double c = std::cos(a_from_b.yaw_rad);
  const double s = std::sin(a_from_b.yaw_rad);
  return {a_from_b.x_m + c * b_from_c.x_m - s * b_from_c.y_m,
          a_from_b.y_m + s * b_from_c.x_m + c * b_from_c.y_m,
          wrapAngle(a_from_b.yaw_rad + b_from_c.yaw_rad)};
}

Eigen::Isometry3d toIsometry(const Pose2& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.translate(Eigen::Vector3d(pose.x_m, pose.y_m, 0.0));
  isometry.rotate(Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()));
  return isometry;
}

Pose2 toPose2(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d forward = pose.linear().col(0);
  return {pose.translation().x(), pose.translation().y(), std::atan2(forward.y(), forward.x())};
}

}  // namespace ramscout_sim
