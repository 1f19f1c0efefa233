// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_kinematics/drive_model.hpp"

namespace ramscout_kinematics {

/// Moves in every direction at any heading: omni wheels, mecanum wheels, steered castors.
struct HolonomicDriveParameters {
  /// Variance of the distance forward per metre forward, and of that to the left per metre to the
  /// left.
  double forward_noise_m2_per_m = 1e-4;
  double lateral_noise_m2_per_m = 2e-4;
  /// Variance of the heading per radian turned and per metre moved in any direction.
  double turn_noise_rad2_per_rad = 1e-3;
  double turn_noise_rad2_per_m = 1e-3;

  static const ram_parameters::ParameterTable<HolonomicDriveParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// White noise on forward, lateral and turning motion, each on its own.
class HolonomicDrive : public DriveModel {
public:
  /// \throws as HolonomicDriveParameters::validate()
  explicit HolonomicDrive(const HolonomicDriveParameters& parameters);
  Eigen::Matrix3d noise(const Eigen::Vector3d& increment) const override;

private:
  HolonomicDriveParameters parameters_;
};

}  // namespace ramscout_kinematics
