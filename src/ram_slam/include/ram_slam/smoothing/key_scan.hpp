// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"

namespace ram_slam {

/// A scan that stands for those about it.
struct KeyScan {
  std::int64_t stamp_ns = 0;
  SurfaceScan surfaces;
  Pose2 base_from_laser;
  Pose2 map_from_laser;
  double path_m = 0.0;  ///< driven up to here, turning counted in
  Eigen::Vector2d view_centre_in_laser_m =
      Eigen::Vector2d::Zero();  ///< middle of what it sees near by

  Pose2 map_from_base() const { return map_from_laser * base_from_laser.inverse(); }
};

}  // namespace ram_slam
