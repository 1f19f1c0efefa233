// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/holonomic_drive.hpp"

#include <cmath>

namespace ramscout_kinematics {
namespace {

const DriveModelRegistration kRegistration(
    "holonomic", driveModelType<HolonomicDrive, HolonomicDriveParameters>());

}  // namespace

const ram_parameters::ParameterTable<HolonomicDriveParameters>& HolonomicDriveParameters::table() {
  using namespace ram_parameters;
  using P = HolonomicDriveParameters;
  static const auto table =
      ParameterTable<P>()
          .add("forward_noise_m2_per_m", &P::forward_noise_m2_per_m, "m^2/m", atLeast(0.0),
               "Variance of the distance forward per metre forward.")
          .add("lateral_noise_m2_per_m", &P::lateral_noise_m2_per_m, "m^2/m", atLeast(0.0),
               "Variance of the distance to the left per metre to the left.")
          .add("turn_noise_rad2_per_rad", &P::turn_noise_rad2_per_rad, "rad^2/rad", atLeast(0.0),
               "Variance of the heading per radian turned.")
          .add("turn_noise_rad2_per_m", &P::turn_noise_rad2_per_m, "rad^2/m", atLeast(0.0),
               "Variance of the heading per metre moved in any direction.");
  return table;
}

void HolonomicDriveParameters::validate() const {
  table().check(*this);
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
