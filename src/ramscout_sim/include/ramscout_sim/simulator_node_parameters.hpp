// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/simulation_parameters.hpp"

namespace ramscout_sim {

/// What a robot may have for itself.
struct RobotParameters {
  /// Namespace of its topics, prefix of its frames; empty: the only robot, without either.
  std::string name;
  /// Tour file; empty: the robot obeys cmd_vel.
  std::string tour;
  /// URDF file; empty: the text in the parameter `robot_description`.
  std::string robot;
  /// Fault file; empty: nothing goes wrong unless inject_fault asks for it.
  std::string faults;
  std::string laser_frame = "laser";
  /// Pose in the world [x, y, yaw]; empty: the world's own start.
  std::vector<double> start;

  /// All but the name.
  static const ram_parameters::ParameterTable<RobotParameters>& table();
};

/// How the simulation waits for those who work on its scans.
struct LockStepParameters {
  /// Topics whose messages begin with a header; empty: it never waits.
  std::vector<std::string> topics;
  /// Wall time after which the simulation continues without an answer.
  double timeout_s = 5.0;
  /// Wall time to wait at the start until every topic has a publisher and scans have a subscriber.
  double start_timeout_s = 30.0;
  /// While partners are starting, a scan may have reached none of them: no long wait for the first
  /// answer.
  double first_answer_s = 0.5;
  /// How often a wait checks whether ROS is shutting down.
  double poll_s = 0.05;

  static const ram_parameters::ParameterTable<LockStepParameters>& table();
};

/// Topics of a robot.
struct TopicParameters {
  int queue_length = 100;
  /// Share of a tour after which tour_progress is published again.
  double progress_step = 1e-3;
  /// Commands of two nodes on cmd_vel within this time are warned of.
  double rival_command_s = 2.0;

  static const ram_parameters::ParameterTable<TopicParameters>& table();
};

/// Everything in config/simulator.yaml.
struct SimulatorNodeParameters {
  /// World file, map, model or mesh; empty: an endless floor.
  std::string world;
  /// What holds for each robot unless its own section overrides it.
  RobotParameters every_robot;
  std::vector<std::string> robot_names;
  /// Simulated seconds per second; 0: as fast as possible.
  double real_time_factor = 1.0;
  double clock_rate_hz = 100.0;
  LockStepParameters lock_step;
  SimulationParameters simulation;
  TopicParameters topics;
  RobotLimits robot_limits;
  /// Longest that the service `step` runs.
  double max_step_s = 3600.0;
  /// A simulation that is later than this does not hurry to catch up.
  double late_s = 0.1;
  /// At least one; made from `robot_names` and the sections of these names.
  std::vector<RobotParameters> robots = {RobotParameters()};

  /// Without the sections of the robots.
  static const ram_parameters::ParameterTable<SimulatorNodeParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads every key; `robots` is a list of names, each the key of a section of its own that
/// overrides what the top level states for all robots.
SimulatorNodeParameters readSimulatorNodeParameters(ram_parameters::ParameterReader& reader);

}  // namespace ramscout_sim
