// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

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

}  // namespace ram_slam
