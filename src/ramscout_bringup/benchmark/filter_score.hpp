// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <ram_slam/geometry/trajectory.hpp>
#include <ram_slam/landmarks/feature.hpp>
#include <ram_slam/sensing/laser_scan.hpp>

#include "ramscout_bringup/slam_pipeline.hpp"

namespace ramscout_bringup {

/// One scan as the filter gets it.
struct FilterStep {
  ram_slam::MountedScan scan;
  ram_slam::FeatureList features;
  ram_slam::Pose2 odom_from_base;
};

/// Which part of the system is judged.
enum class Judged {
  kFilter,    ///< the filter alone
  kDeployed,  ///< as the nodes run it: Tracker, which follows MapSmoother
};

/// How good the estimator was on a recording of which the truth is known.
struct FilterScore {
  double ate_m = 0.0;       ///< of the trajectory at the end
  double odometry_m = 0.0;  ///< the same of the odometry that the filter is given
  double yaw_rad = 0.0;
  double online_ate_m = 0.0;  ///< of the estimates as they were known then
  double online_m = 0.0;      ///< the same in the frame of the start, not aligned
  double nees = 0.0;          ///< mean
  double nees_in_band = 0.0;
  double nees_above_band = 0.0;
  double false_matches = 0.0;  ///< part of all matches
  std::size_t landmarks = 0;
  std::size_t found_again = 0;  ///< of those that could be: seen in both halves
  std::size_t due_again = 0;
  std::size_t in_free_space = 0;
  int times_lost = 0;
};

/// Runs the estimator over the steps, and compares it with the truth, as docs/fast_slam.md
/// describes.
FilterScore scoreFilter(const SlamParameters& parameters,
                        Judged judged,
                        const std::vector<FilterStep>& steps,
                        const ram_slam::Trajectory& truth);

/// A line for people.
void print(const std::string& name, const FilterScore& score);

}  // namespace ramscout_bringup
