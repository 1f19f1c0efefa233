// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/transform_broadcaster.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/InjectFault.h"
#include "ramscout_sim/SetPose.h"
#include "ramscout_sim/SetRate.h"
#include "ramscout_sim/Step.h"
#include "ramscout_sim/ros/fair_mutex.hpp"
#include "ramscout_sim/ros/lock_step.hpp"
#include "ramscout_sim/simulation.hpp"

namespace ramscout_sim_ros {

struct SimulatorParameters {
  /// World file or map (YAML); empty: an endless floor.
  std::string world;
  /// Tour file; empty: the robot obeys cmd_vel.
  std::string tour;
  /// URDF file; empty: the text in the parameter `robot_description`.
  std::string robot;
  /// Fault file; empty: nothing goes wrong unless inject_fault says so.
  std::string faults;
  std::string laser_frame = "laser";
  /// Simulated seconds per second; 0: as fast as possible.
  double real_time_factor = 1.0;
  double clock_rate_hz = 100.0;
  LockStepParameters lock_step;
  ramscout_sim::SimulationParameters simulation;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

SimulatorParameters readSimulatorParameters(ram_parameters::ParameterReader& reader);

/// Runs a Simulation in a thread of its own and puts it on ROS; topics and services are listed in
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
  void publish(const ramscout_sim::Outputs& outputs);
  void publishClock();
  void publishProgress();
  void keepPace();
  void restartPace();
  ramscout_sim::Simulation makeSimulation() const;

  void onCommand(const geometry_msgs::Twist& message);
  bool onInjectFault(ramscout_sim::InjectFault::Request& request,
                     ramscout_sim::InjectFault::Response& response);
  bool onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool onReset(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response);
  bool onSetPose(ramscout_sim::SetPose::Request& request,
                 ramscout_sim::SetPose::Response& response);
  bool onSetRate(ramscout_sim::SetRate::Request& request,
                 ramscout_sim::SetRate::Response& response);
  bool onStep(ramscout_sim::Step::Request& request, ramscout_sim::Step::Response& response);

  SimulatorParameters parameters_;
  ramscout_sim::RobotDescription robot_;
  ramscout_sim::World world_;
  std::optional<ramscout_sim::Tour> tour_;

  // What the simulation's thread shares with the callbacks.
  FairMutex mutex_;
  std::condition_variable_any wake_;
  ramscout_sim::Simulation simulation_;
  bool paused_ = false;
  bool stopping_ = false;
  std::int64_t step_until_ns_ = 0;
  double real_time_factor_ = 1.0;
  ros::SteadyTime pace_wall_start_;
  std::int64_t pace_start_ns_ = 0;

  std::int64_t next_clock_ns_ = 0;
  double published_progress_ = -1.0;

  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};
  ros::Publisher clock_, scan_, odometry_, joints_, ground_truth_, progress_, faults_;
  std::vector<ros::ServiceServer> services_;
  ros::Subscriber command_;
  tf2_ros::TransformBroadcaster tf_;
  LockStep lock_step_;
  std::thread thread_;
};

}  // namespace ramscout_sim_ros
