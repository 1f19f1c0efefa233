// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/fleet.hpp"
#include "ramscout_sim/ros/lock_step.hpp"

namespace ramscout_sim_ros {

/// What one robot of several has for itself.
struct RobotParameters {
  /// Namespace of its topics, prefix of its frames; empty: the only robot, without either.
  std::string name;
  /// Pose in the world [x, y, yaw]; empty: where the world says.
  std::vector<double> start;
  /// Tour file; empty: the robot obeys cmd_vel.
  std::string tour;
  /// URDF file; empty: the text in the parameter `robot_description`.
  std::string robot;
  /// Fault file; empty: nothing goes wrong unless inject_fault says so.
  std::string faults;
  std::string laser_frame = "laser";
};

struct SimulatorParameters {
  /// World file, map, model or mesh; empty: an endless floor.
  std::string world;
  /// At least one.
  std::vector<RobotParameters> robots;
  /// Simulated seconds per second; 0: as fast as possible.
  double real_time_factor = 1.0;
  double clock_rate_hz = 100.0;
  LockStepParameters lock_step;
  ramscout_sim::SimulationParameters simulation;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads every key; `robots` is a list of names, each the key of a section of its own that
/// overrides what the top level says of all robots.
SimulatorParameters readSimulatorParameters(ram_parameters::ParameterReader& reader);

/// Whether the simulation can run at this speed.
bool isRate(double real_time_factor);

/// The robots as their files describe them; robot i draws its noise from seed + i.
std::vector<ramscout_sim::FleetMember> loadMembers(const SimulatorParameters& parameters,
                                                   const ramscout_sim::World& world);

}  // namespace ramscout_sim_ros
