// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/differential_drive.hpp"

#include <cmath>

#include "../check.hpp"

namespace ramscout_kinematics {
namespace {

std::shared_ptr<const DriveModel> readModel(ram_parameters::ParameterReader& reader) {
  return std::make_shared<DifferentialDrive>(readDifferentialDriveParameters(reader));
}

const DriveModelRegistration kRegistration("differential", &readModel);

}  // namespace

void DifferentialDriveParameters::validate() const {
  check(wheel_separation_m > 0.0, "wheel_separation_m", wheel_separation_m, "> 0");
  check(left_noise_m2_per_m >= 0.0, "left_noise_m2_per_m", left_noise_m2_per_m, ">= 0");
  check(right_noise_m2_per_m >= 0.0, "right_noise_m2_per_m", right_noise_m2_per_m, ">= 0");
}

DifferentialDriveParameters readDifferentialDriveParameters(
    ram_parameters::ParameterReader& reader) {
  DifferentialDriveParameters parameters;
  reader.read("wheel_separation_m", parameters.wheel_separation_m);
  reader.read("left_noise_m2_per_m", parameters.left_noise_m2_per_m);
  reader.read("right_noise_m2_per_m", parameters.right_noise_m2_per_m);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

DifferentialDrive::DifferentialDrive(const DifferentialDriveParameters& parameters)
    : parameters_(parameters) {
  parameters_.validate();
}

Eigen::Matrix3d DifferentialDrive::noise(const Eigen::Vector3d& increment) const {
  const double separation_m = parameters_.wheel_separation_m;
  const double half_turn_m = separation_m * increment.z() / 2.0;
  const double left_m2 = parameters_.left_noise_m2_per_m * std::abs(increment.x() - half_turn_m);
  const double right_m2 = parameters_.right_noise_m2_per_m * std::abs(increment.x() + half_turn_m);
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  noise(0, 0) = (right_m2 + left_m2) / 4.0;
  noise(2, 2) = (right_m2 + left_m2) / (separation_m * separation_m);
  noise(0, 2) = noise(2, 0) = (right_m2 - left_m2) / (2.0 * separation_m);
  return noise;
}

}  // namespace ramscout_kinematics
