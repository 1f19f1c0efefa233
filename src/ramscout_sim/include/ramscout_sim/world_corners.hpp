// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// A corner of the free space as a horizontal lidar sees it.
struct WorldCorner {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  /// From the corner into the middle of the free space, in (-pi, pi].
  double orientation_rad = 0.0;
  /// Angle of the free space between the two walls: a room's corner pi / 2, a pillar's 3/2 pi.
  double opening_rad = 0.0;
  /// Lengths of the two walls, to the left and to the right as seen by an observer who stands in
  /// the free space and faces the corner.
  double left_wall_m = 0.0;
  double right_wall_m = 0.0;
};

struct CornerParameters {
  double height_m = 0.37;      ///< of the lidar
  double least_wall_m = 0.05;  ///< walls shorter than this make no corner
  double least_turn_rad = 0.35;
  double resolution_m = 0.05;     ///< of the map that shows what can be reached
  double shortest_edge_m = 2e-3;  ///< shorter ones are left over from joining polygons
  double straight_rad = 0.01;     ///< turns below this are part of a straight wall
  double growth_m = 1e-4;         ///< closes the slits that rounding leaves between walls
  int circle_sides = 64;          ///< of the polygon that stands for a cylinder or sphere

  static const ram_parameters::ParameterTable<CornerParameters>& table();
};

/// The corners where two straight walls of boxes, cylinders and spheres meet, seen from the space
/// that is connected with the start; walls that stand against or through each other (or 0.2 mm
/// apart) are one, and every corner is right to 0.2 mm. Doors and people do not count, nor do
/// meshes, which have no inside. \throws std::invalid_argument from drawMap
std::vector<WorldCorner> cornersOf(const World& world, const CornerParameters& parameters = {});

/// Writes a YAML file with the list `corners`: x, y, orientation_rad, opening_rad, left_wall_m,
/// right_wall_m. \throws std::runtime_error if that fails
void writeCorners(const std::vector<WorldCorner>& corners, const std::string& path);

}  // namespace ramscout_sim
