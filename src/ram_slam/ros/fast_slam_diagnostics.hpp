// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>

#include "ram_slam/stages/estimator_stage.hpp"
#include "ram_slam/stages/loss_counter.hpp"

namespace ram_slam_ros {

/// How the estimator does, once per second on /diagnostics, from a thread of ROS's own: OK while
/// the robot is tracked, WARN if features are rejected, do not come or are not wanted, ERROR while
/// it is lost, a transform is missing or comes from two nodes, most features are rejected, or more
/// than a fifth of the lists are lost or dropped.
class FastSlamDiagnostics {
public:
  /// \param silence_s  without features after which that is a warning
  explicit FastSlamDiagnostics(double silence_s);

  void addFeatures(std::size_t good_count, std::size_t rejected_count);
  void addRejectedList();
  void set(const ram_slam::EstimatorStage& stage,
           const ram_slam::DropCounter& queue_drops,
           const ram_slam::LossCounter& messages,
           bool paused,
           const std::string& problem_of_transforms);

private:
  void publish();
  diagnostic_msgs::DiagnosticStatus status();

  double silence_s_;
  std::mutex mutex_;
  std::uint64_t lists_ = 0;
  std::uint64_t rejected_lists_ = 0;
  std::uint64_t features_ = 0;
  std::uint64_t rejected_features_ = 0;
  std::uint64_t reported_lists_ = 0;
  std::uint64_t reported_rejected_ = 0;
  std::uint64_t reported_good_ = 0;
  ros::WallTime newest_;

  bool paused_ = false;
  std::string problem_of_transforms_;
  bool is_lost_ = false;
  std::string state_ = "tracking";
  std::vector<std::pair<std::string, double>> health_;
  ram_slam::DropCounter drops_;
  ram_slam::DropCounter queue_drops_;
  ram_slam::LossCounter messages_;
  ram_slam::DropShare drop_share_;

  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::WallTimer timer_;
};

}  // namespace ram_slam_ros
