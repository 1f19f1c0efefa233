// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ram_slam/scan_matching/correlative_search.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/pose_graph.hpp"

namespace ram_slam {

/// Settings of the search for loop closures.
struct LoopSearchParameters {
  double min_path_m = 8.0;  ///< between two key scans, along the shortest way through the graph
  double max_view_distance_m =
      3.0;                      ///< between what two scans look at, before drift is allowed for
  double drift_m_per_m = 0.03;  ///< expected of the poses along the path
  double drift_rad_per_m = 0.01;
  double max_distance_m = 15.0;  ///< greatest shift that is searched, to each side
  double max_angle_rad = 0.6;
  int neighbour_count = 4;  ///< key scans on each side that help to recognise a place
  double min_score = 0.45;  ///< mean likelihood of the best pose in the dense search, 0 .. 1
  double min_inlier_ratio =
      0.6;  ///< share of a scan's points that meet a surface of the other place
  double max_free_space_ratio =
      0.05;  ///< share of points that lie where the other place was seen to be free
  double max_round_trip_m = 0.05;  ///< difference between matching there and matching back
  double max_round_trip_rad = 0.015;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// A place that was recognised.
struct LoopMatch {
  PoseEdge edge;  ///< from the old key scan to the new one, between laser poses
  double score = 0.0;
  double inlier_ratio = 0.0;
  /// The place would look as familiar from elsewhere along a corridor; the edge then says nothing
  /// in that direction.
  bool is_ambiguous = false;
};

/// Key scans before `newest` that may see the same place, one of each passage, the most promising
/// first.
///
/// \param path_to_m  for each key scan the length of the shortest way to `newest` through the graph
std::vector<std::size_t> findLoopCandidates(const std::vector<KeyScan>& key_scans,
                                            std::size_t newest,
                                            const std::vector<double>& path_to_m,
                                            const LoopSearchParameters& parameters);

/// Where a key scan is searched that may have drifted along so much path.
SearchWindow searchWindow(double path_m, const LoopSearchParameters& parameters);

/// Matches the key scan `newest` with the place about `candidate`: a dense search over all poses of
/// a window about a guess, an alignment, and the checks of LoopSearchParameters. None if any of
/// them fails.
std::optional<LoopMatch> verifyLoop(const std::vector<KeyScan>& key_scans,
                                    std::size_t candidate,
                                    std::size_t newest,
                                    const Pose2& map_from_laser_guess,
                                    const SearchWindow& window,
                                    const ScanMatcherParameters& matcher,
                                    const LoopSearchParameters& parameters);

}  // namespace ram_slam
