// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_kinematics/drive_model.hpp"

namespace ramscout_kinematics {

/// Two driven wheels on one axle; the base frame sits in the middle of that axle.
struct DifferentialDriveParameters {
  double wheel_separation_m = 0.36;
  /// Variance of a wheel's travel per metre of it: 1e-8 suits odometry refined by scans, 1e-5
  /// (3 mm after 1 m) wheels alone.
  double left_noise_m2_per_m = 1e-8;
  double right_noise_m2_per_m = 1e-8;

  static const ram_parameters::ParameterTable<DifferentialDriveParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// White noise per metre on the travel of each wheel: with r and l the travels of right and left
/// wheel, var(r) = k_r |r|, var(l) = k_l |l|, forward = (r + l) / 2, turn = (r - l) / separation.
class DifferentialDrive : public DriveModel {
public:
  /// \throws as DifferentialDriveParameters::validate()
  explicit DifferentialDrive(const DifferentialDriveParameters& parameters);
  Eigen::Matrix3d noise(const Eigen::Vector3d& increment) const override;

private:
  DifferentialDriveParameters parameters_;
};

}  // namespace ramscout_kinematics
