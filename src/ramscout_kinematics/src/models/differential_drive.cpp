// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/differential_drive.hpp"

#include <cmath>

namespace ramscout_kinematics {
namespace {

const DriveModelRegistration kRegistration(
    "differential", driveModelType<DifferentialDrive, DifferentialDriveParameters>());

}  // namespace

const ram_parameters::ParameterTable<DifferentialDriveParameters>&
DifferentialDriveParameters::table() {
  using namespace ram_parameters;
  using P = DifferentialDriveParameters;
  static const auto table =
      ParameterTable<P>()
          .add("wheel_separation_m", &P::wheel_separation_m, "m", positive(),
               "Distance of the two driven wheels.")
          .add("left_noise_m2_per_m", &P::left_noise_m2_per_m, "m^2/m", atLeast(0.0),
               "Variance of the left wheel's travel per metre of it. 1e-8 suits odometry that "
               "laser_odometry has refined, which the launch files and run_bag use; for wheels "
               "alone take 1e-5 (3 mm after 1 m) or the result of a calibration.")
          .add("right_noise_m2_per_m", &P::right_noise_m2_per_m, "m^2/m", atLeast(0.0),
               "The same for the right wheel.");
  return table;
}

void DifferentialDriveParameters::validate() const {
  table().check(*this);
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
