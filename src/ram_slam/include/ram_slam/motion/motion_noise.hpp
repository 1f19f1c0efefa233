// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Standard deviations of a motion that was measured, by its length and turn.
struct MotionNoise {
  double rest_deviation_m = 0.01;       ///< per axis, of any motion
  double rest_deviation_rad = 0.01;     ///< of any motion
  double deviation_m_per_m = 0.05;      ///< per axis, for each metre
  double deviation_rad_per_m = 0.03;    ///< for each metre
  double deviation_rad_per_rad = 0.05;  ///< for each radian turned

  static const ram_parameters::ParameterTable<MotionNoise>& table();

  /// Of x, y [m] and yaw [rad], in the axes of the start of the motion.
  Eigen::Vector3d deviations(const Pose2& motion) const;
  /// The inverse of the diagonal covariance: diag(deviations)^-2.
  Eigen::Matrix3d information(const Pose2& motion) const;
};

}  // namespace ram_slam
