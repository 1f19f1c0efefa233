// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ramscout_bringup/trajectory_file.hpp"

namespace ramscout_bringup {

/// Statistics of a set of non-negative errors; all zero if there are none.
struct ErrorStatistics {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;  ///< of the sample (n - 1)
  double rms = 0.0;
  double median = 0.0;  ///< the upper one of an even number
  double max = 0.0;
};
ErrorStatistics statisticsOf(std::vector<double> errors);

/// How far a trajectory is from the truth.
struct TruthComparison {
  ram_slam::Pose2 truth_from_map;  ///< the alignment that was used
  ErrorStatistics position_m;      ///< absolute trajectory error (ATE) after alignment
  ErrorStatistics yaw_rad;
  std::size_t without_truth_count = 0;  ///< poses before, after or in a gap of the truth
};

/// Absolute trajectory error: both trajectories at the stamps of `estimate` that the truth spans
/// (truth interpolated, but not over gaps of ten times its median step and more than 1 s), the
/// estimate moved by the rigid motion that minimises the squared distances (Umeyama, PAMI 1991,
/// without scale). \throws std::invalid_argument if fewer than two stamps are common
TruthComparison compareWithTruth(const Trajectory& estimate, const Trajectory& truth);

/// The truth moved to where compareWithTruth() aligns it with the estimate; empty if there is
/// nothing in common to align them by.
Trajectory truthInMap(const Trajectory& estimate, Trajectory truth);

/// Relative pose error over pieces of the path.
struct RelativeError {
  std::string interval;  ///< e.g. "5 m" or "10 s"
  ErrorStatistics position_m;
  ErrorStatistics yaw_rad;
};
/// One row for each length of path [m] and each duration [s]: error of the estimated motion from
/// each pose to the first pose that far on, in the axes of the first pose. No alignment.
std::vector<RelativeError> relativeErrors(const Trajectory& estimate,
                                          const Trajectory& truth,
                                          const std::vector<double>& lengths_m,
                                          const std::vector<double>& durations_s);

/// Length of the path through the positions [m].
double pathLength(const Trajectory& trajectory);

/// What is known of the motion between two instants: a line of a relations file.
struct Relation {
  std::int64_t first_ns = 0;
  std::int64_t second_ns = 0;
  ram_slam::Pose2 first_from_second;
};

/// Lines `t1 t2 x y z roll pitch yaw` [s, m, rad]; `#` starts a comment; plain or packed.
/// \throws std::runtime_error naming file and line if a line is malformed, or the file has no
/// relation
std::vector<Relation> readRelations(const std::string& path);

/// Error of a trajectory against relations (Kuemmerle et al., Autonomous Robots 27(4), 2009).
struct RelationErrors {
  ErrorStatistics position_m;  ///< |t_estimated - t_reference|, the metric's own definition
  ErrorStatistics position_cartographer_m;  ///< |translation of estimated * reference^-1|,
                                            ///< Cartographer's definition
  ErrorStatistics yaw_rad;
};
struct RelationComparison {
  RelationErrors all;
  RelationErrors distant;  ///< pairs more than 30 s apart: what a loop is worth
  double max_stamp_gap_s =
      0.0;  ///< largest distance between a relation's stamp and the pose that was used
  std::size_t moved_count = 0;  ///< stamps more than 0.1 s from any pose, bridged by odometry
  std::size_t far_count = 0;    ///< stamps more than 0.1 s from any pose
};

/// How relations are compared.
struct RelationLimits {
  double max_stamp_gap_s = 0.1;  ///< a pose this near in time is taken as it is
  double distant_s = 30.0;       ///< stamps of a relation farther apart make it a distant one
};

/// For each stamp the pose nearest in time is taken; if it is more than 0.1 s away and odometry is
/// given, it is moved by the odometry between the samples nearest to both instants. No alignment,
/// nothing dropped, all weights 1. \throws std::invalid_argument if the trajectory or the relations
/// are empty
RelationComparison compareWithRelations(const Trajectory& estimate,
                                        const std::vector<Relation>& relations,
                                        const Trajectory& odometry,
                                        const RelationLimits& limits = {});

}  // namespace ramscout_bringup
