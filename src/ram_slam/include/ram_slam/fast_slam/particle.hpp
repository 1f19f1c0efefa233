// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

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

/// Once the best particle's path has more poses than that, all particles get this path with half as
/// many, each with its own newest pose.
void limitPaths(std::vector<Particle>& particles, std::size_t best, std::size_t max_poses);

}  // namespace ram_slam
