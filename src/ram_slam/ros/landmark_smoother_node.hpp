// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <vector>

#include <nav_msgs/Path.h>
#include <ram_slam_msgs/FeatureList.h>
#include <ram_slam_msgs/LandmarkMap.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/smoothing/landmark_smoother.hpp"
#include "ram_slam/stages/input_guard.hpp"

#include "kinematics_client.hpp"

namespace ram_slam_ros {

/// `features`, and the estimator's `trajectory` and `landmarks` in. On `~smooth` all features so
/// far are smoothed at once, beginning with the estimator's newest result: `smoothed_trajectory`
/// and `smoothed_landmarks` out (latched). The estimator follows the first one if it is listening.
class LandmarkSmootherNode {
public:
  /// \throws std::invalid_argument if a parameter is refused
  explicit LandmarkSmootherNode(ram_parameters::ParameterReader& reader);

private:
  void onFeatures(const ros::MessageEvent<const ram_slam_msgs::FeatureList>& event);
  void onTrajectory(const nav_msgs::Path& message);
  void onLandmarks(const ram_slam_msgs::LandmarkMap& message);
  bool onSmooth(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  NodeDiagnostics::Report report() const;
  /// The clock was set back.
  void restart();
  /// Moves lists whose motion the kinematics knows by now from `waiting_` to `steps_`.
  void settle();
  /// The steps within the trajectory.
  std::vector<ram_slam::FeatureStep> covered() const;

  ram_slam::LandmarkSmootherParameters parameters_;
  std::vector<ram_slam::FeatureStep> steps_;
  ram_slam::InputGuard<ram_slam::FeatureList> guard_;
  ram_slam::DropCounter drops_;
  DropLog drop_log_;
  std::deque<ram_slam::FeatureList> waiting_;
  ram_slam::Trajectory trajectory_;
  std::vector<ram_slam::LandmarkEstimate> landmarks_;

  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};
  KinematicsClient kinematics_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Publisher smoothed_trajectory_, smoothed_landmarks_;
  ros::ServiceServer smooth_service_;
  NodeDiagnostics diagnostics_;
  NodeDiagnostics::Input* features_input_ = nullptr;
};

}  // namespace ram_slam_ros
