// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/occupancy/occupancy_grid.hpp"
#include "ramscout_bringup/evaluation.hpp"

namespace ramscout_bringup {

/// How far a map agrees with the true one. Cells of the two maps match if they are at most one cell
/// of the estimate apart.
///
/// Of the true map only what the estimate knows counts: walls are the true occupied cells beside a
/// free one, as far as they lie in or next to cells that the estimate knows.
struct MapAgreement {
  double occupied_iou = 0.0;  ///< matched walls / (matched + spurious + missed walls)
  double free_iou = 0.0;  ///< free in both / (free in both + free in one but occupied in the other)
  double coverage =
      0.0;  ///< part of the true free space, as far as it is connected to the start, that is known
  ErrorStatistics
      wall_distance_m;  ///< from each occupied cell of the estimate to the nearest true wall
};

/// \param true_from_estimate  where the estimate's map frame lies in the frame of the true map
/// \throws std::invalid_argument if a map has no cells, or the true one has no occupied cell
MapAgreement compareMaps(const ram_slam::OccupancyGrid& estimate,
                         const ram_slam::OccupancyGrid& truth,
                         const ram_slam::Pose2& true_from_estimate);

/// What counts as a wall, and what as its double.
struct DoubledWallCriteria {
  int reach_cells = 4;  ///< a wall's direction is that of what is connected within this square
  std::size_t min_cells = 5;  ///< of a wall
  double max_spread = 0.15;   ///< variance across by variance along, beyond which it is no line
  int nearest_cells = 2;      ///< of a parallel wall; nearer ones are one thick wall
  int farthest_cells = 6;
  double parallel_cosine = 0.94;  ///< of 20 degrees
};

/// Doubled walls, the mark of a loop closed badly: occupied cells that have a parallel wall 2 to 6
/// cells away, across a gap.
struct DoubledWalls {
  std::size_t occupied_count = 0;
  double fraction = 0.0;  ///< of the occupied cells; a thin wall seen from both sides counts, too
  double fraction_across_free =
      0.0;  ///< only where cells between the two are free, which a real wall's inside is not
};
DoubledWalls findDoubledWalls(const ram_slam::OccupancyGrid& map,
                              const DoubledWallCriteria& criteria = {});

}  // namespace ramscout_bringup
