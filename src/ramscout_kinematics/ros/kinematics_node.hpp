// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <nav_msgs/Odometry.h>
#include <ram_slam_msgs/PredictState.h>
#include <ram_slam_msgs/PredictStateWithCovariance.h>
#include <ram_slam_msgs/SampleState.h>
#include <ram_slam_msgs/SampleStates.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "ram_parameters/parameter_reader.hpp"
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
  void onOdometry(const nav_msgs::Odometry& message);
  void use(const ramscout_kinematics::OdometrySample& sample);
  bool onPredict(ram_slam_msgs::PredictState::Request& request,
                 ram_slam_msgs::PredictState::Response& response);
  bool onPredictWithCovariance(ram_slam_msgs::PredictStateWithCovariance::Request& request,
                               ram_slam_msgs::PredictStateWithCovariance::Response& response);
  bool onSample(ram_slam_msgs::SampleState::Request& request,
                ram_slam_msgs::SampleState::Response& response);
  bool onSampleStates(ram_slam_msgs::SampleStates::Request& request,
                      ram_slam_msgs::SampleStates::Response& response);
  void publishDiagnostics();
  /// \param received, unused  samples since the last report
  diagnostic_msgs::DiagnosticStatus diagnose(std::uint64_t received, std::uint64_t unused) const;

  ramscout_kinematics::KinematicsParameters parameters_;
  ramscout_kinematics::Kinematics kinematics_;
  std::uint64_t samples_drawn_ = 0;  // touched by the services' thread only

  // Touched by the main thread only; indexed by ramscout_kinematics::Added.
  std::array<std::uint64_t, 7> samples_by_outcome_{};
  ram_slam::InputGuard<ramscout_kinematics::OdometrySample> guard_;
  ram_slam::DropCounter drops_;
  std::uint64_t samples_rejected_ = 0;
  std::uint64_t samples_received_ = 0;
  std::uint64_t diagnosed_received_ = 0;
  std::uint64_t diagnosed_unused_ = 0;
  ros::WallTime newest_arrival_;

  ros::NodeHandle node_;
  ros::CallbackQueue service_queue_;
  ros::Publisher diagnostics_;
  ros::Subscriber odometry_;
  std::array<ros::ServiceServer, 4> services_;
  ros::WallTimer diagnostics_timer_;
  ros::AsyncSpinner service_spinner_;  // last: stops before what it serves is gone
};

}  // namespace ramscout_kinematics_ros
