// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ramscout_sim/pose2.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// Cells along a side: a picture of 256 MiB.
constexpr int kLargestMapSide_cells = 16384;

enum class Cell : std::uint8_t { kFree, kOccupied, kUnknown };

/// A floor plan as map_server has it.
struct MapImage {
  int width_cells = 0;
  int height_cells = 0;
  double resolution_m = 0.05;
  /// World pose of the outer corner of cell (0, 0); x grows with the column, y with the row.
  Pose2 world_from_map;
  /// Row-major, x fastest, row 0 at the bottom.
  std::vector<Cell> cells;

  Cell at(int column, int row) const {
    return cells[static_cast<std::size_t>(row) * width_cells + column];
  }
};

/// Reads map_server's YAML file and the binary PGM (P5, 8 bit) that it names, at most 16384 x 16384
/// cells.
///
/// `image` is a file name, relative to the YAML file if not absolute, never anything else. `mode`
/// must be absent, `trinary` or `scale` (both read as trinary). \throws std::runtime_error or
/// std::invalid_argument naming file, key and reason
MapImage readMap(const std::string& yaml_path);

/// Writes `<path_without_suffix>.pgm` and `.yaml`. \throws std::runtime_error if that fails
void writeMap(const MapImage& map, const std::string& path_without_suffix);

/// Occupied cells as boxes of the given height, few and large (greedy rectangles).
std::vector<Solid> extrude(const MapImage& map, double height_m);

/// The edges of the occupied cells as closed polygons in the world, occupied on the left, without
/// corners that are no more than `tolerance_cells` off the line between those that stay.
std::vector<std::vector<Eigen::Vector2d>> outlinesOf(const MapImage& map, double tolerance_cells);

/// Simplified outlines as upright walls for the lidar: a robot passes through (`solid` is false).
///
/// \param tolerance_cells  as of outlinesOf; the steps of a slanted wall are less than a cell off
/// its line
Solid extrudeOutlines(const MapImage& map, double height_m, double tolerance_cells = 1.0);

/// The true map: what a perfect horizontal lidar at `height_m` would find. Cells that a solid
/// touches are occupied, those connected to the start are free, the others unknown.
/// \param margin_m  that the map extends beyond the solids
MapImage drawMap(const World& world, double height_m, double resolution_m, double margin_m = 1.0);

}  // namespace ramscout_sim
