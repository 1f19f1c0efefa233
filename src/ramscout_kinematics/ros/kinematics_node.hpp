// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include <nav_msgs/Odometry.h>
#include <ram_slam_msgs/PredictState.h>
#include <ram_slam_msgs/PredictStateWithCovariance.h>
#include <ram_slam_msgs/SampleState.h>
#include <ram_slam_msgs/SampleStates.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/stages/input_guard.hpp"
#include "ramscout_kinematics/kinematics.hpp"

namespace ramscout_kinematics_ros {

/// Buffers `odom` and answers ~predict, ~predict_with_covariance, ~sample and ~sample_states.
///
/// The services have a thread of their own, so no answer waits behind odometry or diagnostics, and
/// none waits for odometry to come: what cannot be answered now fails now.
class KinematicsNode {
public:
  explicit KinematicsNode(ram_parameters::ParameterReader& reader);

private:
  void onOdometry(const ros::MessageEvent<const nav_msgs::Odometry>& event);
  /// Whether a publisher counts its messages from the beginning again: it was started again.
  bool isRestart(const std::string& publisher, std::uint32_t number);
  void use(const ramscout_kinematics::OdometrySample& sample);
  bool onPredict(ram_slam_msgs::PredictState::Request& request,
                 ram_slam_msgs::PredictState::Response& response);
  bool onPredictWithCovariance(ram_slam_msgs::PredictStateWithCovariance::Request& request,
                               ram_slam_msgs::PredictStateWithCovariance::Response& response);
  bool onSample(ram_slam_msgs::SampleState::Request& request,
                ram_slam_msgs::SampleState::Response& response);
  bool onSampleStates(ram_slam_msgs::SampleStates::Request& request,
                      ram_slam_msgs::SampleStates::Response& response);
  ram_slam_ros::NodeDiagnostics::Report report() const;

  ramscout_kinematics::KinematicsParameters parameters_;
  ramscout_kinematics::Kinematics kinematics_;
  std::uint64_t samples_drawn_ = 0;  // touched by the services' thread only

  // Touched by the main thread only; indexed by ramscout_kinematics::Added.
  std::array<std::uint64_t, 7> samples_by_outcome_{};
  ram_slam::InputGuard<ramscout_kinematics::OdometrySample> guard_;
  ram_slam::DropCounter drops_;
  ram_slam_ros::DropLog drop_log_;
  ram_slam::LossCounter messages_;
  std::map<std::string, std::uint32_t> newest_numbers_;  ///< by publisher

  ros::NodeHandle node_;
  ros::CallbackQueue service_queue_;
  ros::Subscriber odometry_;
  std::array<ros::ServiceServer, 4> services_;
  ram_slam_ros::NodeDiagnostics diagnostics_;
  ram_slam_ros::NodeDiagnostics::Input& odometry_input_;
  ros::AsyncSpinner service_spinner_;  // last: stops before what it serves is gone
};

}  // namespace ramscout_kinematics_ros
