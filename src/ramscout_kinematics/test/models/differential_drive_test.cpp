// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/differential_drive.hpp"

#include <gtest/gtest.h>

namespace ramscout_kinematics {
namespace {

TEST(DifferentialDrive, TurningOnTheSpotErrsInYawOnly) {
  const DifferentialDrive model({0.4, 1e-4, 1e-4});
  const Eigen::Matrix3d noise = model.noise({0.0, 0.0, 1.0});  // each wheel 0.2 m
  EXPECT_NEAR(noise(2, 2), 2.0 * 0.2e-4 / 0.16, 1e-15);
  EXPECT_NEAR(noise(0, 0), 0.2e-4 / 2.0, 1e-15);
  EXPECT_NEAR(noise(0, 2), 0.0, 1e-15);
}

TEST(DifferentialDrive, TurningAroundOneWheelErrsByTheOther) {
  const DifferentialDrive model({0.4, 7.0, 1e-4});
  const Eigen::Matrix3d noise = model.noise({0.2, 0.0, 1.0});  // left 0, right 0.4 m
  EXPECT_NEAR(noise(0, 0), 0.4e-4 / 4.0, 1e-15);
  EXPECT_NEAR(noise(0, 2), 0.4e-4 / 0.8, 1e-15);
  EXPECT_NEAR(noise(2, 2), 0.4e-4 / 0.16, 1e-15);
}

TEST(DifferentialDrive, NoiseGrowsWithTheDistance) {
  const DifferentialDrive model({0.4, 1e-4, 3e-4});
  const Eigen::Vector3d increment(0.5, 0.0, -0.3);
  EXPECT_TRUE(model.noise(3.0 * increment).isApprox(3.0 * model.noise(increment), 1e-14));
}

TEST(DifferentialDrive, RefusesParametersOutOfRange) {
  EXPECT_THROW(DifferentialDrive({0.0, 1e-4, 1e-4}), std::invalid_argument);
  EXPECT_THROW(DifferentialDrive({0.4, -1e-4, 1e-4}), std::invalid_argument);
  EXPECT_THROW(DifferentialDrive({0.4, 1e-4, -1e-4}), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_kinematics
