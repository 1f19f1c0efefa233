// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/ackermann_drive.hpp"

#include <algorithm>
#include <cmath>

#include "../check.hpp"

namespace ramscout_kinematics {
namespace {

std::shared_ptr<const DriveModel> readModel(ram_parameters::ParameterReader& reader) {
  return std::make_shared<AckermannDrive>(readAckermannDriveParameters(reader));
}

const DriveModelRegistration kRegistration("ackermann", &readModel);

}  // namespace

void AckermannDriveParameters::validate() const {
  check(wheelbase_m > 0.0, "wheelbase_m", wheelbase_m, "> 0");
  check(max_steering_rad > 0.0 && max_steering_rad < M_PI_2, "max_steering_rad", max_steering_rad,
        "in (0, pi/2)");
  check(distance_noise_m2_per_m >= 0.0, "distance_noise_m2_per_m", distance_noise_m2_per_m, ">= 0");
  check(steering_sigma_rad >= 0.0, "steering_sigma_rad", steering_sigma_rad, ">= 0");
  check(steering_correlation_m > 0.0, "steering_correlation_m", steering_correlation_m, "> 0");
}

AckermannDriveParameters readAckermannDriveParameters(ram_parameters::ParameterReader& reader) {
  AckermannDriveParameters parameters;
  reader.read("wheelbase_m", parameters.wheelbase_m);
  reader.read("max_steering_rad", parameters.max_steering_rad);
  reader.read("distance_noise_m2_per_m", parameters.distance_noise_m2_per_m);
  reader.read("steering_sigma_rad", parameters.steering_sigma_rad);
  reader.read("steering_correlation_m", parameters.steering_correlation_m);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
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
