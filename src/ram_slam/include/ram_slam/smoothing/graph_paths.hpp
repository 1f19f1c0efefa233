// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "ram_slam/smoothing/key_scan.hpp"

namespace ram_slam {

/// Pairs of key scans that a closed loop joins.
using Shortcuts = std::vector<std::pair<std::size_t, std::size_t>>;

/// The length of the shortest way from each key scan to one of them, along the path that was driven
/// and over shortcuts (Dijkstra). No way leads across a jump; infinite where there is none.
/// \param shortcut_m  length of a shortcut
std::vector<double> pathLengthsTo(std::size_t target,
                                  const std::vector<KeyScan>& key_scans,
                                  const Shortcuts& shortcuts,
                                  double shortcut_m);

}  // namespace ram_slam
