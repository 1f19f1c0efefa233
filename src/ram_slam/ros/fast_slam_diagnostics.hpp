// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>

#include "ram_slam/tracking/tracker.hpp"

namespace ram_slam_ros {

/// Why the robot does not know where it is, in words.
std::string toText(ram_slam::LostReason reason);

/// How the filter does, once per second on /diagnostics, from a thread of ROS's own: OK while the
/// robot is tracked, WARN if features are rejected, do not come or are not wanted, ERROR while it
/// is lost or most features are rejected.
class FastSlamDiagnostics {
public:
  FastSlamDiagnostics();

  void addFeatures(std::size_t good_count, std::size_t rejected_count);
  void addRejectedList();
  void set(const ram_slam::Tracker& slam, bool paused);

private:
  void publish();
  diagnostic_msgs::DiagnosticStatus status();

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
  ram_slam::LostReason reason_ = ram_slam::LostReason::kTracking;
  ram_slam::MapAgreement agreement_;
  ram_slam::FastSlamQuality quality_;
  std::size_t landmarks_ = 0;

  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::WallTimer timer_;
};

}  // namespace ram_slam_ros
