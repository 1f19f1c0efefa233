// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nav_msgs/Odometry.h>
#include <ram_slam_msgs/FeatureList.h>
#include <ram_slam_msgs/Tracking.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/stages/smoothing_stage.hpp"

#include "matcher_plugins.hpp"
#include "mounted_scans.hpp"

namespace ram_slam_ros {

/// `scan` and `odom` (best from laser_odometry) in, `features` if there are any,
/// `smoothed_trajectory` out (latched): the pose of the base at every scan, whenever a correction
/// moved the robot and on `~optimize`; `map_pose` out: the pose of the base at each key scan as the
/// map of then has it. The estimator follows both. `~undo_closure` takes the newest accepted
/// closure back. `smoothing_status` follows each scan. With a loaded
/// map nothing is taken in before the robot is found in it (`tracking`).
class MapSmootherNode {
public:
  /// \throws std::invalid_argument if a parameter is refused
  explicit MapSmootherNode(ram_parameters::ParameterReader& reader);

private:
  void onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event);
  void onOdometry(const ros::MessageEvent<const nav_msgs::Odometry>& event);
  void onFeatures(const ram_slam_msgs::FeatureList& message);
  void onTracking(const ram_slam_msgs::Tracking& message);
  bool onOptimize(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onUndoClosure(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  NodeDiagnostics::Report report() const;
  void processWaiting();
  void logNewClosures();
  void publish(const ram_slam::Trajectory& smoothed);
  void publishMapPose(std::int64_t stamp_ns, const ram_slam::Pose2& map_from_base);
  void publishStatus(std::int64_t stamp_ns);

  ram_slam::MapSmootherParameters parameters_;
  MatcherPlugins matchers_;
  ram_slam::SmoothingStage stage_;
  int reset_count_ = 0;  ///< that was logged
  std::size_t logged_closures_ = 0;
  std::uint32_t correction_count_ = 0;
  // Longer than tf's usual: a recording may be played many times faster than real time.
  tf2_ros::Buffer transforms_{ros::Duration(60.0)};
  tf2_ros::TransformListener listener_{transforms_};
  MountedScans scans_;
  ram_slam::InputGuard<ram_slam::StampedPose2> odometry_guard_;
  DropLog drop_log_;
  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};
  ros::Publisher publisher_;
  ros::Publisher map_pose_publisher_;
  ros::Publisher status_publisher_;
  ros::Subscriber scan_subscriber_;
  ros::Subscriber odometry_subscriber_;
  ros::Subscriber features_subscriber_;
  ros::Subscriber tracking_subscriber_;
  ros::ServiceServer optimize_service_;
  ros::ServiceServer undo_service_;
  NodeDiagnostics diagnostics_;
  NodeDiagnostics::Input* scan_input_ = nullptr;
  NodeDiagnostics::Input* odometry_input_ = nullptr;
};

}  // namespace ram_slam_ros
