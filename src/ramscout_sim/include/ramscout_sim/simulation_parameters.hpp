// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/actors.hpp"
#include "ramscout_sim/drive.hpp"
#include "ramscout_sim/lidar_parameters.hpp"
#include "ramscout_sim/physics_parameters.hpp"
#include "ramscout_sim/ray_caster.hpp"
#include "ramscout_sim/tour.hpp"
#include "ramscout_sim/wheel_odometry.hpp"

namespace ramscout_sim {

struct SimulationParameters {
  int seed = 1;
  double physics_rate_hz = 1000.0;
  double odometry_rate_hz = 100.0;
  /// The widest that ray casting uses.
  InstructionSet instruction_set = InstructionSet::kAvx2;
  DriveParameters drive;
  OdometryParameters odometry;
  LidarParameters lidar;
  PhysicsParameters physics;
  ActorParameters actors;
  TourDriverParameters tour_driver;
  /// How many shares of its way the fault `push` tries, the whole first, until one ends in the
  /// free.
  int push_tries = 10;
  /// Of the cube that the fault `payload` puts on the chassis: water's.
  double payload_density_kgpm3 = 1000.0;

  static const ram_parameters::ParameterTable<SimulationParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// Reads every key of the table, after the lidar's preset. Leaves unknown keys to the caller, who
/// may have more.
SimulationParameters readSimulationParameters(ram_parameters::ParameterReader& reader);

}  // namespace ramscout_sim
