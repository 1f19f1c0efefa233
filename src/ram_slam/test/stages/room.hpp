// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "ram_slam/stages/scan_synchroniser.hpp"

namespace ram_slam {

/// What a lidar with a beam per degree sees at (x, 0) in a room of 10 m by 6 m about the origin.
inline MountedScan scanInRoom(std::int64_t stamp_ns, double x_m) {
  MountedScan scan;
  scan.scan.stamp_ns = stamp_ns;
  scan.scan.angle_min_rad = -M_PI;
  scan.scan.angle_increment_rad = M_PI / 180.0;
  scan.scan.range_min_m = 0.1F;
  scan.scan.range_max_m = 20.0F;
  for (int beam = 0; beam < 360; ++beam) {
    const double bearing_rad = scan.scan.bearing_rad(beam);
    const double dx = std::cos(bearing_rad);
    const double dy = std::sin(bearing_rad);
    const double to_x = dx > 0.0 ? (5.0 - x_m) / dx : (-5.0 - x_m) / dx;
    const double to_y = dy > 0.0 ? 3.0 / dy : -3.0 / dy;
    scan.scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y)));
  }
  return scan;
}

}  // namespace ram_slam
