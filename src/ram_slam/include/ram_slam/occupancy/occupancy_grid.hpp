// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Values of an occupancy grid's cells, as nav_msgs/OccupancyGrid has them: these three, or a
/// probability in percent.
constexpr std::int8_t kUnknownCell = -1;
constexpr std::int8_t kFreeCell = 0;
constexpr std::int8_t kOccupiedCell = 100;

/// Most cells of one grid that is read or kept: 100 MB in memory, as a message and as an image.
constexpr std::size_t kMaxGridCells = 100'000'000;

/// A map as consumers know it (nav_msgs/OccupancyGrid): one value per cell, row-major, x fastest,
/// from the lower left.
struct OccupancyGrid {
  double resolution_m = 0.05;      ///< edge of a cell
  Pose2 map_from_grid;             ///< lower-left corner of cell (0, 0)
  int width = 0;                   ///< cells along x
  int height = 0;                  ///< cells along y
  std::vector<std::int8_t> cells;  ///< width * height values: -1 unknown, 0 free .. 100 occupied

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  /// Value of a cell; unknown outside the grid.
  std::int8_t at(int x, int y) const { return contains(x, y) ? cells[index(x, y)] : kUnknownCell; }
};

}  // namespace ram_slam
