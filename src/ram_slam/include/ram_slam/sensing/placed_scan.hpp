// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// A scan of a map, and where it was taken.
struct PlacedScan {
  LaserScan scan;
  Pose2 base_from_laser;
  Pose2 map_from_laser;  ///< at the first beam
  Pose2 last_beam;       ///< the laser at the last beam, seen from the first one

  Pose2 map_from_base() const { return map_from_laser * base_from_laser.inverse(); }
};

}  // namespace ram_slam
