// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include "ramscout_sim/InjectFault.h"
#include "ramscout_sim/SetPose.h"
#include "ramscout_sim/fleet.hpp"
#include "ramscout_sim/simulator_node_parameters.hpp"

namespace ramscout_sim_ros {

/// Topics and services of one simulated robot. With a name, topics are in the namespace of that
/// name and frames begin with `name/`.
class RobotInterface {
public:
  /// Does something with the robot's simulation while no other thread does.
  using Access = std::function<void(const std::function<void(ramscout_sim::Simulation&)>&)>;

  RobotInterface(const std::string& name,
                 const ramscout_sim::FleetMember& member,
                 const ramscout_sim::TopicParameters& topics,
                 Access access);
  RobotInterface(const RobotInterface&) = delete;
  RobotInterface& operator=(const RobotInterface&) = delete;

  void publish(const ramscout_sim::Outputs& outputs, tf2_ros::TransformBroadcaster& tf);
  /// How far the tour is, and whether something is touched; only when it changes.
  void publishState(const ramscout_sim::Simulation& simulation);
  /// After a reset.
  void forgetState();

  const ros::Publisher& scans() const { return scan_; }
  std::string commandTopic() const { return command_.getTopic(); }

private:
  void onCommand(const ros::MessageEvent<geometry_msgs::Twist const>& event);
  void warnOfOtherCommander(const std::string& commander);
  void warnOfImpossible(const geometry_msgs::Twist& message) const;
  bool onInjectFault(ramscout_sim::InjectFault::Request& request,
                     ramscout_sim::InjectFault::Response& response);
  bool onSetPose(ramscout_sim::SetPose::Request& request,
                 ramscout_sim::SetPose::Response& response);

  std::string prefix_;  // of frames
  ramscout_sim::RobotDescription robot_;
  ramscout_sim::SimulationParameters parameters_;
  ramscout_sim::TopicParameters topics_;
  bool has_tour_;
  Access access_;
  double published_progress_ = -1.0;
  int published_collision_ = -1;
  std::string commander_;
  ros::SteadyTime commanded_at_;

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  ros::Publisher scan_, odometry_, joints_, ground_truth_, progress_, faults_, collision_;
  ros::Subscriber command_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace ramscout_sim_ros
