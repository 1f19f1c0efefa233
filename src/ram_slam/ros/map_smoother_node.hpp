// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nav_msgs/Odometry.h>
#include <ram_slam_msgs/FeatureList.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Trigger.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"

#include "matcher_plugins.hpp"
#include "scan_odometry_queue.hpp"

namespace ram_slam_ros {

/// `scan` and `odom` (best from laser_odometry) in, `features` if there are any,
/// `smoothed_trajectory` out (latched): the pose of the base at every scan, whenever a correction
/// moved the robot and on `~optimize`. The estimator follows it. `~undo_closure` takes the newest
/// accepted closure back.
class MapSmootherNode {
public:
  /// \throws std::invalid_argument if a parameter is refused
  explicit MapSmootherNode(ram_parameters::ParameterReader& reader);

private:
  void onScan(const sensor_msgs::LaserScan& message);
  void onOdometry(const nav_msgs::Odometry& message);
  void onFeatures(const ram_slam_msgs::FeatureList& message);
  bool onOptimize(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onUndoClosure(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  void processWaiting();
  void logNewClosures();
  void optimize();
  void publish();

  ram_slam::MapSmootherParameters parameters_;
  MatcherPlugins matchers_;
  ram_slam::MapSmoother smoother_;
  ScanOdometryQueue queue_;
  std::int64_t last_stamp_ns_ = 0;
  std::size_t logged_closures_ = 0;
  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};
  ros::Publisher publisher_;
  ros::Subscriber scan_subscriber_;
  ros::Subscriber odometry_subscriber_;
  ros::Subscriber features_subscriber_;
  ros::ServiceServer optimize_service_;
  ros::ServiceServer undo_service_;
};

}  // namespace ram_slam_ros
