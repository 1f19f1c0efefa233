// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/FeatureList.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/motion/gap_bridge.hpp"
#include "ram_slam/tracking/tracker.hpp"

#include "checkpoint_keeper.hpp"
#include "fast_slam_diagnostics.hpp"
#include "fast_slam_node_parameters.hpp"
#include "kinematics_client.hpp"
#include "laser_views.hpp"
#include "map_to_odom_publisher.hpp"
#include "matcher_plugins.hpp"

namespace ram_slam_ros {

/// Tracker in a ROS graph. Callbacks only queue; one thread runs the filter, another one
/// keeps tf valid, so that neither a slow update nor a missing kinematics node holds up the other.
class FastSlamNode {
public:
  explicit FastSlamNode(ram_parameters::ParameterReader& reader);
  ~FastSlamNode();
  FastSlamNode(const FastSlamNode&) = delete;
  FastSlamNode& operator=(const FastSlamNode&) = delete;

private:
  void onFeatures(const ram_slam_msgs::FeatureList& message);
  void onScan(const sensor_msgs::LaserScanConstPtr& message);
  /// Puts a list in its place by stamp; the caller holds queue_mutex_.
  void enqueue(ram_slam::FeatureList list);
  /// Bends the map along what a smoother found.
  void onSmoothedTrajectory(const nav_msgs::Path& message);
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message);
  bool onGlobalLocalization(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);

  void subscribe();
  void advertise();
  /// The thread of the filter.
  void run();
  void process(const ram_slam::FeatureList& list);
  /// False if the motion up to the list is not known yet.
  bool tryUpdate(const ram_slam::FeatureList& list);
  void restart(const std::string& reason);
  std::unique_ptr<ram_slam::Tracker> makeFilter() const;
  /// False without a checkpoint of use.
  bool goOnFromCheckpoint();
  /// For want of the kinematics' motion up to a list: what tf tells, or nothing; then a checkpoint
  /// does not say where the robot is now.
  void bridgeGap(std::int64_t stamp_ns);
  void loadInitialMap();
  void publishPose();
  void publishLost();
  void publishMap();

  FastSlamNodeParameters node_parameters_;
  ram_slam::FastSlamParameters parameters_;
  ram_slam::RecoveryParameters recovery_parameters_;
  MatcherPlugins matchers_;

  ros::NodeHandle node_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_{buffer_};
  LaserViews views_;
  MapToOdomPublisher map_to_odom_;
  KinematicsClient kinematics_;
  ram_slam::GapBridge motion_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::Publisher pose_, particles_, landmarks_, landmark_markers_, trajectory_,
      corrected_trajectory_, lost_;

  CheckpointKeeper checkpoints_;
  std::timed_mutex filter_mutex_;
  std::unique_ptr<ram_slam::Tracker> filter_;
  std::optional<bool> published_lost_;
  std::int64_t last_output_ns_ = 0;
  bool interrupted_ = false;
  bool from_checkpoint_ = false;  ///< and nothing has come since
  std::string missing_motion_;    ///< why the last list could not be used yet

  std::mutex queue_mutex_;
  std::condition_variable queue_changed_;
  std::deque<ram_slam::FeatureList> queue_;
  std::atomic<bool> paused_{false};
  std::atomic<bool> stop_{false};
  FastSlamDiagnostics diagnostics_;
  std::thread thread_;
};

}  // namespace ram_slam_ros
