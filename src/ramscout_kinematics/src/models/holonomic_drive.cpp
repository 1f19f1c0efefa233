// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/holonomic_drive.hpp"

#include <cmath>

#include "../check.hpp"

namespace ramscout_kinematics {
namespace {

std::shared_ptr<const DriveModel> readModel(ram_parameters::ParameterReader& reader) {
  return std::make_shared<HolonomicDrive>(readHolonomicDriveParameters(reader));
}

const DriveModelRegistration kRegistration("holonomic", &readModel);

}  // namespace

void HolonomicDriveParameters::validate() const {
  check(forward_noise_m2_per_m >= 0.0, "forward_noise_m2_per_m", forward_noise_m2_per_m, ">= 0");
  check(lateral_noise_m2_per_m >= 0.0, "lateral_noise_m2_per_m", lateral_noise_m2_per_m, ">= 0");
  check(turn_noise_rad2_per_rad >= 0.0, "turn_noise_rad2_per_rad", turn_noise_rad2_per_rad, ">= 0");
  check(turn_noise_rad2_per_m >= 0.0, "turn_noise_rad2_per_m", turn_noise_rad2_per_m, ">= 0");
}

HolonomicDriveParameters readHolonomicDriveParameters(ram_parameters::ParameterReader& reader) {
  HolonomicDriveParameters parameters;
  reader.read("forward_noise_m2_per_m", parameters.forward_noise_m2_per_m);
  reader.read("lateral_noise_m2_per_m", parameters.lateral_noise_m2_per_m);
  reader.read("turn_noise_rad2_per_rad", parameters.turn_noise_rad2_per_rad);
  reader.read("turn_noise_rad2_per_m", parameters.turn_noise_rad2_per_m);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

HolonomicDrive::HolonomicDrive(const HolonomicDriveParameters& parameters)
    : parameters_(parameters) {
  parameters_.validate();
}

Eigen::Matrix3d HolonomicDrive::noise(const Eigen::Vector3d& increment) const {
  const Eigen::Vector3d distance = increment.cwiseAbs();
  return Eigen::Vector3d(parameters_.forward_noise_m2_per_m * distance.x(),
                         parameters_.lateral_noise_m2_per_m * distance.y(),
                         parameters_.turn_noise_rad2_per_rad * distance.z() +
                             parameters_.turn_noise_rad2_per_m * distance.head<2>().norm())
      .asDiagonal();
}

}  // namespace ramscout_kinematics
