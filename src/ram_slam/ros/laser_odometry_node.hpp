// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/calibration/stamp_offset.hpp"
#include "ram_slam/scan_matching/laser_odometry.hpp"

#include "scan_odometry_queue.hpp"

namespace ram_slam_ros {

/// `scan` and `odom` in, `laser_odom` out: the same message, refined, at each scan's stamp.
/// Publishes no tf: odom to base stays the wheels'.
class LaserOdometryNode {
public:
  /// \throws std::invalid_argument if a parameter is refused
  explicit LaserOdometryNode(ram_parameters::ParameterReader& reader);

private:
  void onScan(const sensor_msgs::LaserScan& message);
  void onOdometry(const nav_msgs::Odometry& message);
  void processWaiting();
  void publish(const ram_slam::LaserOdometryEstimate& estimate);

  ram_slam::LaserOdometryParameters parameters_;
  ram_slam::LaserOdometry odometry_;
  ram_slam::StampOffset stamp_offset_;
  ScanOdometryQueue queue_;
  std::int64_t last_stamp_ns_ = 0;
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::Subscriber scan_subscriber_;
  ros::Subscriber odometry_subscriber_;
};

}  // namespace ram_slam_ros
