// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/loop_search.hpp"

namespace ram_slam {

/// Two key scans that may see the same place, and where the later one is searched.
struct LoopQuery {
  std::size_t candidate = 0;   ///< the earlier key scan
  std::size_t newest = 0;      ///< the later one
  Pose2 map_from_laser_guess;  ///< of the later one: centre of the window
  SearchWindow window;
};

/// A place that was recognised.
struct LoopMatch {
  PoseEdge edge;  ///< from the old key scan to the new one, between laser poses
  double score = 0.0;
  double inlier_ratio = 0.0;
  /// The scan fits nearly as well elsewhere along a corridor; the edge then has no information in
  /// that direction.
  bool is_ambiguous = false;
};

/// Matches the later key scan with the place about the earlier one: a dense search over all poses
/// of a window about a guess, an alignment, and the checks of LoopSearchParameters. None if any of
/// them fails.
std::optional<LoopMatch> verifyLoop(const std::vector<KeyScan>& key_scans,
                                    const LoopQuery& query,
                                    const ScanMatcherParameters& matcher,
                                    const LoopSearchParameters& parameters);

}  // namespace ram_slam
