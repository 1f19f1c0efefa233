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

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/FeatureList.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/stages/authority_guard.hpp"
#include "ram_slam/stages/estimator_stage.hpp"
#include "ram_slam/stages/fast_slam_node_parameters.hpp"
#include "ram_slam/stages/input_guard.hpp"

#include "checkpoint_keeper.hpp"
#include "fast_slam_diagnostics.hpp"
#include "kinematics_client.hpp"
#include "laser_views.hpp"
#include "map_to_odom_publisher.hpp"
#include "matcher_plugins.hpp"

namespace ram_slam_ros {

/// An estimator in a ROS graph. Callbacks only queue; one thread runs the estimator, another one
/// keeps tf valid, so that neither a slow update nor a missing kinematics node holds up the other.
class FastSlamNode {
public:
  explicit FastSlamNode(ram_parameters::ParameterReader& reader);
  ~FastSlamNode();
  FastSlamNode(const FastSlamNode&) = delete;
  FastSlamNode& operator=(const FastSlamNode&) = delete;

private:
  void onFeatures(NodeDiagnostics::Input& input,
                  const ros::MessageEvent<const ram_slam_msgs::FeatureList>& event);
  void onScan(const sensor_msgs::LaserScanConstPtr& message);
  void onTransforms(const ros::MessageEvent<const tf2_msgs::TFMessage>& event);
  /// Puts a list in its place by stamp; the caller holds queue_mutex_.
  void enqueue(ram_slam::FeatureList list);
  /// Bends the map along what a smoother found.
  void onSmoothedTrajectory(const nav_msgs::Path& message);
  void onMapPose(const geometry_msgs::PoseStamped& message);
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message);
  bool onGlobalLocalization(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);

  void subscribe();
  void subscribeFeatures(const std::string& topic, bool is_needed);
  void advertise();
  /// The thread of the estimator.
  void run();
  void process(const ram_slam::FeatureList& list);
  /// False if the motion up to the list is not known yet.
  bool tryUpdate(const ram_slam::FeatureList& list);
  /// Follows the smoothed trajectory that arrived last, if there is one.
  void followCorrection();
  void followMapPoses();
  /// The stage has begun again; the caller holds stage_mutex_.
  void afterReset(const std::string& reason);
  /// False without a usable checkpoint.
  bool restoreCheckpoint();
  /// For want of the kinematics' motion up to a list: the motion of tf, or none; then a checkpoint
  /// does not state where the robot is now.
  void bridgeGap(std::int64_t stamp_ns);
  /// map_from_base at a stamp; the caller holds stage_mutex_.
  void publishPose(std::int64_t stamp_ns, const ram_slam::Pose2& map_from_base);
  /// The same at the estimator's stamp.
  void publishPose();
  void publishLost();
  /// Never waits for the estimator.
  NodeDiagnostics::Report report();
  void publishMap();

  ram_slam::FastSlamNodeParameters node_parameters_;
  double future_interpol_s_ = 0.0;
  MatcherPlugins matchers_;
  ram_slam::EstimatorFactory make_estimator_;

  ros::NodeHandle node_;
  // Longer than tf's usual: the wheels bridge an interruption of the refined odometry.
  tf2_ros::Buffer buffer_{ros::Duration(120.0)};
  tf2_ros::TransformListener listener_{buffer_};
  LaserViews views_;
  MapToOdomPublisher map_to_odom_;
  KinematicsClient kinematics_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::Publisher pose_, particles_, landmarks_, landmark_markers_, trajectory_,
      corrected_trajectory_, lost_, tracking_, amcl_pose_;

  CheckpointKeeper checkpoints_;
  std::timed_mutex stage_mutex_;
  ram_slam::EstimatorStage stage_;
  std::int64_t last_output_ns_ = 0;
  bool interrupted_ = false;
  bool from_checkpoint_ = false;  ///< and nothing has come since
  DropLog drop_log_;
  DropLog queue_log_;

  std::mutex queue_mutex_;
  std::condition_variable queue_changed_;
  ram_slam::InputGuard<ram_slam::FeatureList> guard_;
  std::deque<ram_slam::FeatureList> queue_;
  std::optional<ram_slam::Trajectory> smoothed_;  ///< newest one that arrived
  std::deque<ram_slam::StampedPose2> map_poses_;  ///< those that arrived since the last reading
  ram_slam::DropCounter queue_drops_;
  ram_slam::LossCounter messages_;
  ram_slam::AuthorityGuard authorities_;
  std::atomic<bool> paused_{false};
  std::atomic<bool> stop_{false};
  FastSlamDiagnostics health_;
  NodeDiagnostics diagnostics_;
  std::thread thread_;
};

}  // namespace ram_slam_ros
