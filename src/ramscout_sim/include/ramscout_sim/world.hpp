// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "ramscout_sim/pose2.hpp"

namespace ramscout_sim {

enum class Shape { kBox, kCylinder, kSphere };

/// A solid that does not move.
struct Solid {
  Shape shape = Shape::kBox;
  Eigen::Isometry3d world_from_solid = Eigen::Isometry3d::Identity();
  /// Box: edge lengths along its axes; cylinder (axis z): diameter, diameter, height; sphere: three
  /// times the diameter.
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
};

/// What the world consists of; z up, the floor is the plane z = 0.
struct World {
  std::vector<Solid> solids;
  /// Where the robot starts.
  Pose2 start;
  /// Coulomb friction between wheels and floor.
  double floor_friction = 0.8;
};

/// A box that stands on the floor. `thickness_m` is centred on the line between the two ends.
Solid makeWall(const Eigen::Vector2d& begin_m,
               const Eigen::Vector2d& end_m,
               double thickness_m,
               double height_m);

/// Corners of the smallest upright box around all solids; the unit box if there are none.
Eigen::AlignedBox3d boundsOf(const World& world);

/// Reads a world by what the file is: a map_server map (YAML with the key `image`), or a world file
/// (YAML without).
///
/// A world file is described in config/worlds/README.md. A map's occupied cells become walls of 2.5
/// m, and the robot starts at the origin. \throws std::runtime_error or std::invalid_argument
/// naming file, element and reason
World readWorld(const std::string& path);

}  // namespace ramscout_sim
