// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/ackermann_drive.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "../drives.hpp"

namespace ramscout_kinematics {
namespace {

AckermannDriveParameters parameters() {
  AckermannDriveParameters parameters;
  parameters.wheelbase_m = 0.5;
  parameters.distance_noise_m2_per_m = 2e-5;
  parameters.steering_sigma_rad = 0.01;
  parameters.steering_correlation_m = 0.3;
  return parameters;
}

TEST(AckermannDrive, StraightDriveHasTheClosedFormNoise) {
  Kinematics kinematics(unlimited(std::make_shared<AckermannDrive>(parameters())));
  const double l = 4.0;
  addAll(kinematics, drive({1.0, 0.0, 0.0}, l, 0.05));
  const double q_t = 0.01 * 0.01 * 0.3 / 0.25;
  const Eigen::Matrix3d covariance = kinematics.motion(after(0.0), after(l)).covariance;
  EXPECT_NEAR(covariance(0, 0), 2e-5 * l, 1e-12);
  EXPECT_NEAR(covariance(1, 1), q_t * l * l * l / 3.0, 1e-12);
  EXPECT_NEAR(covariance(2, 2), q_t * l, 1e-12);
  EXPECT_NEAR(covariance(0, 2), 0.0, 1e-12);
}

/// The steering angle is redrawn every correlation length, the distance errs every metre: wheels
/// simulated one by one.
TEST(AckermannDrive, NoiseAgreesWithASimulatedSteering) {
  const double steering_rad = 0.3, length_m = 3.0, correlation_m = 0.3, wheelbase_m = 0.5;
  const double turn_per_metre = std::tan(steering_rad) / wheelbase_m;
  Kinematics kinematics(unlimited(std::make_shared<AckermannDrive>(parameters())));
  addAll(kinematics, drive({1.0, 0.0, turn_per_metre}, length_m, 0.05));
  const Eigen::Matrix3d covariance = kinematics.motion(after(0.0), after(length_m)).covariance;

  ram_slam::Random random(11);
  const int runs = 20000;
  double turn_variance = 0.0;
  double turn_distance = 0.0;
  for (int run = 0; run < runs; ++run) {
    double turned_rad = 0.0;
    double driven_m = 0.0;
    for (int piece = 0; piece < 10; ++piece) {
      const double steering = steering_rad + 0.01 * random.gaussian();
      const double distance_m = correlation_m + std::sqrt(2e-5 * correlation_m) * random.gaussian();
      turned_rad += distance_m * std::tan(steering) / wheelbase_m;
      driven_m += distance_m;
    }
    const double error_rad = turned_rad - turn_per_metre * length_m;
    turn_variance += error_rad * error_rad / runs;
    turn_distance += error_rad * (driven_m - length_m) / runs;
  }
  EXPECT_NEAR(turn_variance / covariance(2, 2), 1.0, 3.5 * std::sqrt(2.0 / runs));
  EXPECT_NEAR(turn_distance, 2e-5 * length_m * turn_per_metre, 3e-6);
}

TEST(AckermannDrive, NoiseGrowsWithTheDistanceForwardAndBackward) {
  const AckermannDrive model(parameters());
  const Eigen::Vector3d increment(0.5, 0.0, 0.3);
  EXPECT_TRUE(model.noise(3.0 * increment).isApprox(3.0 * model.noise(increment), 1e-14));
  EXPECT_TRUE(model.noise(-increment).isApprox(model.noise(increment), 1e-14));
  EXPECT_EQ(model.noise(Eigen::Vector3d::Zero()), Eigen::Matrix3d::Zero());
}

TEST(AckermannDrive, TurnThatItCannotDriveErrsAsTheSharpestItCan) {
  const AckermannDrive model(parameters());
  const double least_m = 0.5 / std::tan(parameters().max_steering_rad);
  EXPECT_TRUE(model.noise({0.0, 0.0, 1.0}).isApprox(model.noise({least_m, 0.0, 1.0}), 1e-12));
}

TEST(AckermannDrive, RefusesParametersOutOfRange) {
  const auto refuses = [](double AckermannDriveParameters::*field, double value) {
    AckermannDriveParameters bad;
    bad.*field = value;
    EXPECT_THROW(AckermannDrive{bad}, std::invalid_argument);
  };
  refuses(&AckermannDriveParameters::wheelbase_m, 0.0);
  refuses(&AckermannDriveParameters::max_steering_rad, M_PI_2);
  refuses(&AckermannDriveParameters::distance_noise_m2_per_m, -1.0);
  refuses(&AckermannDriveParameters::steering_sigma_rad, -1.0);
  refuses(&AckermannDriveParameters::steering_correlation_m, 0.0);
}

}  // namespace
}  // namespace ramscout_kinematics
