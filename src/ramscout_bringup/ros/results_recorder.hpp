// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/LandmarkMap.h>
#include <ros/ros.h>
#include <std_msgs/Float32.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup_ros {

/// What the recorder must find to call a run good.
struct ResultsRecorderParameters {
  std::string output;  ///< folder to write to; must exist
  /// Whether a simulator publishes the truth and how much of its tour is done. If not, the run is
  /// over when no pose comes any more for silence_timeout_s, and its errors are not known.
  bool has_ground_truth = true;
  double max_position_error_m =
      0.15;  ///< bound of the root mean square after alignment with the truth
  double max_yaw_error_rad = 0.0262;  ///< likewise (1.5 degrees)
  double start_timeout_s = 60.0;      ///< wall time to wait for the first pose
  /// Wall time without progress after which the run has failed; without a truth: is over.
  double silence_timeout_s = 60.0;
  double settle_time_s =
      10.0;  ///< wall time to wait for the last map and trajectory after the tour
  double poll_period_s = 0.05;  ///< wall time between two checks of what has arrived
  /// The last map and the last trajectory end at most so long before the last pose.
  std::int64_t last_path_lag_ns = 1'500'000'000;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};
ResultsRecorderParameters readResultsRecorderParameters(ram_parameters::ParameterReader& reader);

/// Listens to a run of the whole stack until the tour or the recording is over, then writes the
/// result files and, if the truth is known, a verdict.
class ResultsRecorder {
public:
  explicit ResultsRecorder(ResultsRecorderParameters parameters);

  /// Blocks until the tour is over and everything is written; shows progress on standard output.
  /// \return whether the estimate is within the bounds; true if there is no truth
  /// \throws std::runtime_error if nothing is received for too long, naming the topics that were
  /// silent
  bool run();

private:
  void waitForTour();
  void waitForSilence();
  /// Compares with the truth: adds to the summary. \return whether the bounds are kept
  bool judge(ramscout_bringup::Results& run) const;
  void waitForLastMessages();
  std::string silentTopics() const;
  ramscout_bringup::Results results() const;

  ResultsRecorderParameters parameters_;
  ros::NodeHandle node_;
  std::vector<ros::Subscriber> subscribers_;
  std::optional<nav_msgs::OccupancyGrid> map_;
  std::optional<nav_msgs::Path> path_;
  std::optional<ram_slam_msgs::LandmarkMap> landmarks_;
  ramscout_bringup::Trajectory online_;
  ramscout_bringup::Trajectory ground_truth_;
  ramscout_bringup::Trajectory odometry_;
  double progress_ = 0.0;
  ros::WallTime started_;
};

}  // namespace ramscout_bringup_ros
