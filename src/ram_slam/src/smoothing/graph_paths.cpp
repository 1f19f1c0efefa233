// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/graph_paths.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>

namespace ram_slam {
namespace {

/// From a key scan to the next one; a loaded map does not drift.
double stepLength(const std::vector<KeyScan>& key_scans, std::size_t from) {
  if (key_scans[from].is_loaded && key_scans[from + 1].is_loaded) return 0.0;
  return key_scans[from + 1].path_m - key_scans[from].path_m;
}

}  // namespace

std::vector<double> pathLengthsTo(std::size_t target,
                                  const std::vector<KeyScan>& key_scans,
                                  const Shortcuts& shortcuts,
                                  double shortcut_m) {
  Shortcuts ways = shortcuts;  // both ways, by where they begin
  for (const auto& [from, to] : shortcuts) ways.emplace_back(to, from);
  std::sort(ways.begin(), ways.end());
  std::vector<double> length_m(key_scans.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto reach = [&](std::size_t node, double length) {
    if (length >= length_m[node]) return;
    length_m[node] = length;
    queue.emplace(length, node);
  };
  reach(target, 0.0);
  while (!queue.empty()) {
    const auto [length, node] = queue.top();
    queue.pop();
    if (length > length_m[node]) continue;
    if (node > 0 && !key_scans[node].is_jump)
      reach(node - 1, length + stepLength(key_scans, node - 1));
    if (node + 1 < key_scans.size() && !key_scans[node + 1].is_jump)
      reach(node + 1, length + stepLength(key_scans, node));
    for (auto way = std::lower_bound(ways.begin(), ways.end(), std::pair(node, std::size_t{0}));
         way != ways.end() && way->first == node; ++way) {
      reach(way->second, length + shortcut_m);
    }
  }
  return length_m;
}

}  // namespace ram_slam
