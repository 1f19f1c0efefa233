// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_kinematics/drive_model.hpp"

namespace ramscout_kinematics {

/// Steered front wheels, driven rear axle; the base frame sits in the middle of the rear axle.
struct AckermannDriveParameters {
  double wheelbase_m = 0.40;
  /// Steepest steering angle; sharper turns are taken to be driven at this angle.
  double max_steering_rad = 0.7;
  /// Variance of the distance per metre driven.
  double distance_noise_m2_per_m = 1e-4;
  /// Standard deviation of the steering angle, and the distance over which its errors stay alike.
  double steering_sigma_rad = 0.02;
  double steering_correlation_m = 0.5;

  static const ram_parameters::ParameterTable<AckermannDriveParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// turn = distance tan(steering) / wheelbase, with white noise per metre on the distance and on the
/// steering angle: per metre q_distance = k, q_turn = (tan(steering) / wheelbase)^2 k + sigma^2 l /
/// (wheelbase^2 cos^4(steering)), q_both = k tan(steering) / wheelbase.
class AckermannDrive : public DriveModel {
public:
  /// \throws as AckermannDriveParameters::validate()
  explicit AckermannDrive(const AckermannDriveParameters& parameters);
  Eigen::Matrix3d noise(const Eigen::Vector3d& increment) const override;

private:
  AckermannDriveParameters parameters_;
};

}  // namespace ramscout_kinematics
