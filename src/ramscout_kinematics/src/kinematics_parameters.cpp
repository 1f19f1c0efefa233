// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/kinematics_parameters.hpp"

#include <stdexcept>

#include "ramscout_kinematics/parameter_files.hpp"

namespace ramscout_kinematics {

const ram_parameters::ParameterTable<KinematicsNodeParameters>& KinematicsNodeParameters::table() {
  using namespace ram_parameters;
  using P = KinematicsNodeParameters;
  static const auto table =
      ParameterTable<P>()
          .add("odom_frame", &P::odom_frame,
               "Frame that the odometry must be in, otherwise it is rejected; '' accepts any.")
          .add("base_frame", &P::base_frame,
               "Child frame that the odometry must have; '' accepts any.")
          .add("seed", &P::seed, "", anyNumber(),
               "Of the random numbers of the service `sample`. (`sample_states` gets one with each "
               "request.)")
          .expert("Node")
          .add("max_states", &P::max_states, "", atLeast(1),
               "Most states in a request of `sample_states`.");
  return table;
}

const ram_parameters::ParameterTable<KinematicsParameters>& KinematicsParameters::table() {
  using namespace ram_parameters;
  using P = KinematicsParameters;
  static const auto table =
      ParameterTable<P>()
          .add("model", &P::model,
               "Kind of drive: ackermann, differential or holonomic. Its own parameters are in the "
               "section of that name.")
          .add("standing_sigma_m", &P::standing_sigma_m, "m", atLeast(0.0),
               "Standard deviation of the position after 1 s of standing still.")
          .add("standing_sigma_rad", &P::standing_sigma_rad, "rad", atLeast(0.0),
               "Standard deviation of the heading after 1 s of standing still.")
          .include(&P::buffer, OdometryBufferParameters::table())
          .expert("Noise")
          .add(
              "noise_factor", &P::noise_factor, "", positive(),
              "By which the variances of the drive model are multiplied. run_bag --wheels-only and "
              "features.launch laser_odometry:=false set it to 1000, because the shipped variances "
              "are those of odometry that scans have refined.")
          .expert("Standing still")
          .add("standing_speed_mps", &P::standing_speed_mps, "m/s", atLeast(0.0),
               "A robot stands still that is slower than this and turns slower than the next.")
          .add("standing_turn_rate_radps", &P::standing_turn_rate_radps, "rad/s", atLeast(0.0),
               "See above.")
          .heading("Node")
          .include(&P::node, KinematicsNodeParameters::table());
  return table;
}

void KinematicsParameters::validate() const {
  table().check(*this);
  if (drive_model == nullptr) throw std::invalid_argument("no drive model of kind " + model);
}

KinematicsParameters readKinematicsParameters(ram_parameters::ParameterReader& reader) {
  KinematicsParameters parameters;
  KinematicsParameters::table().read(reader, parameters);
  parameters.drive_model = makeDriveModel(parameters.model);
  for (const auto& [name, type] : driveModels()) {
    ram_parameters::ParameterReader section = reader.section(name);
    const auto model = type.read(section);
    if (name == parameters.model) parameters.drive_model = model;
  }
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

std::vector<ram_parameters::ParameterFile> parameterFiles() {
  ram_parameters::ParameterFile file{
      "kinematics.yaml", "ramscout_kinematics/kinematics",
      "Motion of the robot between any two stamps, from buffered odometry. Only the section of the "
      "chosen model is used, but all of them are checked.",
      KinematicsParameters::table().rows()};
  for (const auto& [name, type] : driveModels()) append(file.rows, type.rows(), name);
  return {file};
}

}  // namespace ramscout_kinematics
