// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// A distance and an angle: what counts as "moved or turned far enough".
struct MotionGate {
  double distance_m = 0.0;
  double angle_rad = 0.0;

  /// At least so far, or turned at least so much.
  bool isReachedBy(const Pose2& motion) const {
    return motion.translation().norm() >= distance_m || std::abs(motion.yaw_rad) >= angle_rad;
  }
  /// Farther, or turned by more.
  bool isExceededBy(const Pose2& motion) const {
    return motion.translation().norm() > distance_m || std::abs(motion.yaw_rad) > angle_rad;
  }
};

/// Rows of a gate within the table of its owner; `include` them with a prefix ("key_scan_").
/// \param text  what the gate decides
inline ram_parameters::ParameterTable<MotionGate> motionGateTable(const std::string& text) {
  return ram_parameters::ParameterTable<MotionGate>()
      .add("distance_m", &MotionGate::distance_m, "m", ram_parameters::positive(), text)
      .add("angle_rad", &MotionGate::angle_rad, "rad", ram_parameters::positive(),
           "The same of the turn.");
}

}  // namespace ram_slam
