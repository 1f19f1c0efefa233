// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup {

inline constexpr std::int64_t kSecond = 1'000'000'000;

/// A room of 10 x 6 m with its lower left corner at the origin, a wall below, and a path along its
/// middle.
/// \param first_s  stamp of the first pose; the others follow each second
inline Results roomResults(std::int64_t first_s) {
  Results results;
  results.map.width = 200;
  results.map.height = 120;
  results.map.cells.assign(200 * 120, ram_slam::kFreeCell);
  for (int x = 0; x < 200; ++x)
    results.map.cells[results.map.index(x, 0)] = ram_slam::kOccupiedCell;
  for (int i = 0; i <= 8; ++i)
    results.trajectory.push_back({kSecond * (first_s + i), {1.0 + i, 3.0, 0.0}});
  return results;
}

}  // namespace ramscout_bringup
