// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/motion_noise.hpp"

#include <cmath>

namespace ram_slam {

const ram_parameters::ParameterTable<MotionNoise>& MotionNoise::table() {
  using namespace ram_parameters;
  using P = MotionNoise;
  static const auto table =
      ParameterTable<P>()
          .add("rest_deviation_m", &P::rest_deviation_m, "m", positive(),
               "Standard deviation of the position after a motion of any length, per axis.")
          .add("rest_deviation_rad", &P::rest_deviation_rad, "rad", positive(),
               "Standard deviation of the heading after a motion of any length.")
          .add("deviation_m_per_m", &P::deviation_m_per_m, "m/m", positive(),
               "What each metre adds to the deviation of the position.")
          .add("deviation_rad_per_m", &P::deviation_rad_per_m, "rad/m", positive(),
               "What each metre adds to the deviation of the heading.")
          .add("deviation_rad_per_rad", &P::deviation_rad_per_rad, "rad/rad", positive(),
               "What each radian of turning adds to the deviation of the heading.");
  return table;
}

Eigen::Vector3d MotionNoise::deviations(const Pose2& motion) const {
  const double distance_m = motion.translation().norm();
  const double deviation_m = rest_deviation_m + deviation_m_per_m * distance_m;
  const double deviation_rad = rest_deviation_rad + deviation_rad_per_m * distance_m +
                               deviation_rad_per_rad * std::abs(motion.yaw_rad);
  return {deviation_m, deviation_m, deviation_rad};
}

Eigen::Matrix3d MotionNoise::information(const Pose2& motion) const {
  return deviations(motion).cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace ram_slam
