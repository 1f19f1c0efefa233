// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"
#include "ram_slam/smoothing/key_scan.hpp"

namespace ram_slam {

/// Settings of the dense search for a loop.
struct DenseSearchParameters {
  double resolution_m = 0.1;         ///< side of a cell
  double reading_deviation_m = 0.1;  ///< standard deviation of a reading
  int levels = 5;                    ///< of the likelihood pyramid
  double max_range_m = 12.0;         ///< farther readings cross several cells per angle step
  int query_point_count = 250;       ///< about so many points are searched for
  double angle_step_rad = 0.015;
  double reserve_m = 0.5;  ///< searched even without drift
  double reserve_rad = 0.1;

  static const ram_parameters::ParameterTable<DenseSearchParameters>& table();
};

/// Settings of the test whether the scans of a loop fit elsewhere, too.
struct CorridorTestParameters {
  double min_crossing_sine = 0.5;  ///< of the angle between a direction and walls that fix it
  int min_crossing_points = 20;
  double min_rival_shift_m = 0.4;  ///< nearer, the peak itself is still high
  double max_rival_score = 0.75;   ///< share of the best score

  static const ram_parameters::ParameterTable<CorridorTestParameters>& table();
};

/// Settings of the search for loop closures and of their verification. Keys are those of
/// config/map_smoother.yaml without "loop_".
struct LoopSearchParameters {
  double min_path_m = 8.0;           ///< between two key scans, the shortest way through the graph
  double max_view_distance_m = 3.0;  ///< between two view centres, before drift is allowed for
  double drift_m_per_m = 0.05;       ///< expected of the poses along the path
  double drift_rad_per_m = 0.01;
  double max_distance_m = 15.0;  ///< greatest shift that is searched, to each side
  double max_angle_rad = 0.6;
  int neighbour_count = 4;        ///< key scans on each side that help to recognise a place
  int max_neighbour_count = 20;   ///< the same where they see few points
  int min_points = 60;            ///< of a passage, without which no place is recognised
  double min_score = 0.45;        ///< mean likelihood of the best pose in the dense search, 0 .. 1
  double min_inlier_ratio = 0.6;  ///< share of a scan's points that meet a surface of the place
  double max_free_space_ratio = 0.05;  ///< share of points where the place was seen to be free
  double max_round_trip_m = 0.05;      ///< difference between matching there and matching back
  double max_round_trip_rad = 0.015;
  double free_space_margin_m = 0.25;  ///< a point so far in front of what was seen is in free space
  double prior_information = 100.0;   ///< of the place found: 0.1 m, 0.1 rad
  DenseSearchParameters dense;
  CorridorTestParameters corridor;

  static const ram_parameters::ParameterTable<LoopSearchParameters>& table();
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

/// The key scan whose view centre is nearest to a place in the map.
struct NearestView {
  std::size_t key = 0;
  double distance_m = std::numeric_limits<double>::infinity();
};

/// \param max_path_m  key scans farther along the path are not considered
NearestView nearestView(const std::vector<KeyScan>& key_scans,
                        const Eigen::Vector2d& place_m,
                        double max_path_m);

}  // namespace ram_slam
