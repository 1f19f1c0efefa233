// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/ackermann_drive.hpp"

#include <algorithm>
#include <cmath>

namespace ramscout_kinematics {
namespace {

const DriveModelRegistration kRegistration(
    "ackermann", driveModelType<AckermannDrive, AckermannDriveParameters>());

}  // namespace

const ram_parameters::ParameterTable<AckermannDriveParameters>& AckermannDriveParameters::table() {
  using namespace ram_parameters;
  using P = AckermannDriveParameters;
  static const auto table =
      ParameterTable<P>()
          .add("wheelbase_m", &P::wheelbase_m, "m", positive(), "Distance of front and rear axle.")
          .add("max_steering_rad", &P::max_steering_rad, "rad", positive(),
               "Steepest steering angle; sharper turns are taken to be driven at this angle.")
          .rule(&P::max_steering_rad, "< pi/2",
                [](const P& p) { return p.max_steering_rad < M_PI_2; })
          .add("distance_noise_m2_per_m", &P::distance_noise_m2_per_m, "m^2/m", atLeast(0.0),
               "Variance of the distance per metre driven.")
          .add("steering_sigma_rad", &P::steering_sigma_rad, "rad", atLeast(0.0),
               "Standard deviation of the steering angle.")
          .add("steering_correlation_m", &P::steering_correlation_m, "m", positive(),
               "Distance over which the errors of the steering angle stay alike.");
  return table;
}

void AckermannDriveParameters::validate() const {
  table().check(*this);
}

AckermannDrive::AckermannDrive(const AckermannDriveParameters& parameters)
    : parameters_(parameters) {
  parameters_.validate();
}

Eigen::Matrix3d AckermannDrive::noise(const Eigen::Vector3d& increment) const {
  const double wheelbase_m = parameters_.wheelbase_m;
  // The least distance that the turn takes: a sharper one is the odometry's error, not less noise.
  const double least_m =
      std::abs(increment.z()) * wheelbase_m / std::tan(parameters_.max_steering_rad);
  const double distance_m =
      std::copysign(std::max(std::abs(increment.x()), least_m), increment.x());
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  if (distance_m == 0.0) return noise;

  const double curvature = increment.z() / distance_m;
  const double tan_steering = curvature * wheelbase_m;
  const double turn_per_steering = (1.0 + tan_steering * tan_steering) / wheelbase_m;
  const double steering_noise = std::pow(turn_per_steering * parameters_.steering_sigma_rad, 2) *
                                parameters_.steering_correlation_m;
  const double distance_noise = parameters_.distance_noise_m2_per_m;
  noise(0, 0) = distance_noise;
  noise(0, 2) = noise(2, 0) = curvature * distance_noise;
  noise(2, 2) = curvature * curvature * distance_noise + steering_noise;
  return std::abs(distance_m) * noise;
}

}  // namespace ramscout_kinematics
