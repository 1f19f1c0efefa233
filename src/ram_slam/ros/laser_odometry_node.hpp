// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>
#include <ram_slam_msgs/LidarCalibration.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/stages/odometry_stage.hpp"

#include "mounted_scans.hpp"

namespace ram_slam_ros {

/// `scan` and `odom` in, `laser_odom` out: the same message, refined, at each scan's stamp; and on
/// `lidar_calibration` what it learns about the lidar.
/// Publishes no tf: odom to base stays the wheels'.
class LaserOdometryNode {
public:
  /// \throws std::invalid_argument if a parameter is refused
  explicit LaserOdometryNode(ram_parameters::ParameterReader& reader);

private:
  void onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event);
  void onOdometry(const ros::MessageEvent<const nav_msgs::Odometry>& event);
  NodeDiagnostics::Report report() const;
  void processWaiting();
  void publish(const ram_slam::LaserOdometryEstimate& estimate);
  void publishCalibration();
  /// Publishes the calibration if it has changed.
  void followCalibration();
  void publish(std::int64_t stamp_ns, const ram_slam::PoseWithCovariance2& odom_from_base);

  ram_slam::LaserOdometryParameters parameters_;
  ram_slam::OdometryStage stage_;
  int reset_count_ = 0;               ///< that was logged
  double added_mirror_turn_s_ = 0.0;  ///< that was published
  // Longer than tf's usual: a recording may be played many times faster than real time.
  tf2_ros::Buffer transforms_{ros::Duration(60.0)};
  tf2_ros::TransformListener listener_{transforms_};
  MountedScans scans_;
  ram_slam::InputGuard<ram_slam::StampedPose2> odometry_guard_;
  DropLog drop_log_;
  ros::SteadyTime stuck_;  ///< when the wheels were seen to be stuck the last time
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::Publisher calibration_publisher_;
  ros::Subscriber scan_subscriber_;
  ros::Subscriber odometry_subscriber_;
  NodeDiagnostics diagnostics_;
  NodeDiagnostics::Input& scan_input_;
  NodeDiagnostics::Input* odometry_input_ = nullptr;
};

}  // namespace ram_slam_ros
