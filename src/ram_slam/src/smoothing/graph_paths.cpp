// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/graph_paths.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>

namespace ram_slam {

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
    const double path_m = key_scans[node].path_m;
    if (node > 0 && !key_scans[node].is_jump)
      reach(node - 1, length + path_m - key_scans[node - 1].path_m);
    if (node + 1 < key_scans.size() && !key_scans[node + 1].is_jump)
      reach(node + 1, length + key_scans[node + 1].path_m - path_m);
    for (auto way = std::lower_bound(ways.begin(), ways.end(), std::pair(node, std::size_t{0}));
         way != ways.end() && way->first == node; ++way) {
      reach(way->second, length + shortcut_m);
    }
  }
  return length_m;
}

}  // namespace ram_slam
