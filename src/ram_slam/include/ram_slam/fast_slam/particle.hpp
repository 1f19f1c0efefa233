// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/fast_slam/landmark_tree.hpp"
#include "ram_slam/fast_slam/path.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// One guess of the robot's path, and the map that follows from it.
struct Particle {
  Pose2 map_from_base;           ///< where it was when its map was updated last
  PoseWithCovariance2 proposal;  ///< where it is now, given its map
  double log_weight = 0.0;
  LandmarkTree landmarks;
  Path path;
};

}  // namespace ram_slam
