// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "ram_slam/occupancy/occupancy_grid.hpp"
#include "ram_slam/world_map/world_map.hpp"
#include "ramscout_bringup/changed_parameters.hpp"
#include "ramscout_bringup/measurement.hpp"
#include "ramscout_bringup/trajectory_file.hpp"

namespace ramscout_bringup {

/// A landmark of the final map.
struct MapLandmark {
  std::uint32_t id = 0;
  std::string type;
  std::string classifier;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();         ///< in the map frame
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();  ///< of the position
  double existence_log_odds = 0.0;
};

/// A place that the smoother recognised.
struct ClosureRecord {
  std::int64_t old_stamp_ns = 0;
  std::int64_t new_stamp_ns = 0;
  double score = 0.0;         ///< of the search, at most 1
  double inlier_ratio = 0.0;  ///< part of the scan's points that met a surface
  double correction_m = 0.0;  ///< how far it moved the newest pose when it was found
  bool is_accepted = false;   ///< false: the rest of the graph contradicts it
};

/// What a run leaves behind, whether it ran live or offline.
struct Results {
  ram_slam::OccupancyGrid map;
  std::vector<MapLandmark> landmarks;
  Trajectory trajectory;         ///< the final estimate: map_from_base at each scan's stamp
  Trajectory trajectory_online;  ///< the estimate as it was known at each stamp
  /// The estimator's own trajectory as it stood at the end, before the final smoothing; may be
  /// empty
  Trajectory trajectory_filter;
  Trajectory ground_truth;     ///< empty if unknown; in a frame of its own
  Trajectory odometry;         ///< odom_from_base as the wheels have it, thinned; may be empty
  std::string pose_graph_g2o;  ///< empty if no graph was made
  ram_slam::WorldMap world;    ///< the map to continue or to localise in; may be empty
  nlohmann::ordered_json summary;

  // Only for the report.
  std::vector<ClosureRecord> closures;
  std::vector<Measurement> measurements;
  std::size_t scan_count = 0;  ///< that were there to be used; 0 if unknown
  /// What was run and how, as name and value.
  std::vector<std::pair<std::string, std::string>> about;
  std::vector<ChangedParameter> changed_parameters;
};

/// Writes map.pgm, map.yaml, map.png, trajectory.tum, trajectory_online.tum, landmarks.yaml,
/// summary.json, report.html and, if there, trajectory_filter.tum, ground_truth.tum and
/// pose_graph.g2o. Each file replaces an older one in one step. \throws std::system_error naming
/// the file and the system's reason
void writeResults(const Results& results, const std::string& folder);

/// The landmarks as YAML: a list of maps with the fields of MapLandmark, covariance row by row.
std::string toYaml(const std::vector<MapLandmark>& landmarks);

}  // namespace ramscout_bringup
