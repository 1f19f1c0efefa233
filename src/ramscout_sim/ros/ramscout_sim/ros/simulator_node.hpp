// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/transform_broadcaster.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/SetRate.h"
#include "ramscout_sim/Step.h"
#include "ramscout_sim/fleet.hpp"
#include "ramscout_sim/ros/fair_mutex.hpp"
#include "ramscout_sim/ros/lock_step.hpp"
#include "ramscout_sim/ros/robot_interface.hpp"
#include "ramscout_sim/simulator_node_parameters.hpp"

namespace ramscout_sim_ros {

/// Runs a Fleet in a thread of its own and puts it on ROS; topics and services are listed in
/// the package's README.
class SimulatorNode {
public:
  explicit SimulatorNode(ram_parameters::ParameterReader& reader);
  ~SimulatorNode();
  SimulatorNode(const SimulatorNode&) = delete;
  SimulatorNode& operator=(const SimulatorNode&) = delete;

private:
  void advertise();
  void run();
  bool waitUntilRunning();
  void publish(const std::vector<ramscout_sim::Outputs>& outputs, const ros::Time& now);
  void publishClock();
  void keepPace();
  void restartPace();

  bool onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool onReset(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response);
  bool onSetRate(ramscout_sim::SetRate::Request& request,
                 ramscout_sim::SetRate::Response& response);
  bool onStep(ramscout_sim::Step::Request& request, ramscout_sim::Step::Response& response);

  ramscout_sim::SimulatorNodeParameters parameters_;
  ramscout_sim::World world_;
  std::vector<ramscout_sim::FleetMember> members_;

  // What the simulation's thread shares with the callbacks.
  FairMutex mutex_;
  std::condition_variable_any wake_;
  ramscout_sim::Fleet fleet_;
  bool paused_ = false;
  bool stopping_ = false;
  std::int64_t step_until_ns_ = 0;
  double real_time_factor_ = 1.0;
  ros::SteadyTime pace_wall_start_;
  std::int64_t pace_start_ns_ = 0;

  std::int64_t next_clock_ns_ = 0;

  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};
  ros::Publisher clock_;
  std::vector<ros::ServiceServer> services_;
  std::vector<std::unique_ptr<RobotInterface>> robots_;
  tf2_ros::TransformBroadcaster tf_;
  LockStep lock_step_;
  std::thread thread_;
};

}  // namespace ramscout_sim_ros
