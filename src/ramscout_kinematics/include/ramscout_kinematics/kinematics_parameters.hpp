// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_kinematics/drive_model.hpp"
#include "ramscout_kinematics/odometry_buffer.hpp"

namespace ramscout_kinematics {

/// What only the node `kinematics` uses.
struct KinematicsNodeParameters {
  /// Frames that the odometry must be in; empty accepts any.
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  /// Of the service `sample`, whose requests carry none.
  int seed = 1;
  /// Most states in a request of `sample_states`.
  int max_states = 100000;

  static const ram_parameters::ParameterTable<KinematicsNodeParameters>& table();
};

struct KinematicsParameters {
  /// Name of the drive model; its own parameters are in a section of that name.
  std::string model = "differential";
  std::shared_ptr<const DriveModel> drive_model = makeDriveModel("differential");
  OdometryBufferParameters buffer;
  double noise_factor = 1.0;  ///< by which the variance of the drive model is multiplied
  /// Standard deviation of where a robot is that has seemed to stand still for 1 s; grows with the
  /// root of the time.
  double standing_sigma_m = 0.001;
  double standing_sigma_rad = 0.001;
  /// Slower than both of these a robot seems to stand still.
  double standing_speed_mps = 0.005;
  double standing_turn_rate_radps = 0.005;
  KinematicsNodeParameters node;

  /// Without the parameters of the drive models.
  static const ram_parameters::ParameterTable<KinematicsParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads the whole of config/kinematics.yaml, the sections of the models that are not chosen
/// included. \throws std::invalid_argument for an unknown key, a wrong type or a value out of range
KinematicsParameters readKinematicsParameters(ram_parameters::ParameterReader& reader);

}  // namespace ramscout_kinematics
