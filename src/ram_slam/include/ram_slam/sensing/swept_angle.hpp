// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace ram_slam {

/// The angle from the first beam of a scan to a bearing, in the direction of the sweep [rad]: it
/// has the sign of the increment and is less than a turn. Bearings may differ by whole turns. Half
/// an increment before the first beam is still the first beam: the angle then has the other sign.
inline double sweptAngle_rad(double bearing_rad, double angle_min_rad, double angle_increment_rad) {
  const double turn_rad = std::copysign(2.0 * M_PI, angle_increment_rad);
  const double from_first_rad = bearing_rad - angle_min_rad;
  const double turns = std::floor((from_first_rad + 0.5 * angle_increment_rad) / turn_rad);
  return from_first_rad - turns * turn_rad;
}

}  // namespace ram_slam
