// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/holonomic_drive.hpp"

#include <gtest/gtest.h>

#include "../drives.hpp"

namespace ramscout_kinematics {
namespace {

TEST(HolonomicDrive, SidewaysDriveHasTheClosedFormNoise) {
  const double q_lateral = 3e-4, q_turn = 2e-4, l = 2.5;
  Kinematics kinematics(unlimited(
      std::make_shared<HolonomicDrive>(HolonomicDriveParameters{1e-4, q_lateral, 1e-3, q_turn})));
  addAll(kinematics, drive({0.0, 1.0, 0.0}, l, 0.05));
  const auto motion = kinematics.motion(after(0.0), after(l));
  EXPECT_NEAR(motion.pose.y_m, l, 1e-9);
  EXPECT_NEAR(motion.covariance(1, 1), q_lateral * l, 1e-12);
  EXPECT_NEAR(motion.covariance(0, 0), q_turn * l * l * l / 3.0, 1e-12);
  EXPECT_NEAR(motion.covariance(2, 2), q_turn * l, 1e-12);
  EXPECT_NEAR(motion.covariance(0, 2), -q_turn * l * l / 2.0, 1e-12);
}

TEST(HolonomicDrive, TurningOnTheSpotErrsInYawOnly) {
  const HolonomicDrive model({1e-4, 2e-4, 3e-3, 4e-3});
  EXPECT_TRUE(model.noise({0.0, 0.0, -2.0})
                  .isApprox(Eigen::Vector3d(0.0, 0.0, 6e-3).asDiagonal().toDenseMatrix()));
}

TEST(HolonomicDrive, NoiseGrowsWithTheDistance) {
  const HolonomicDrive model({1e-4, 2e-4, 3e-3, 4e-3});
  const Eigen::Vector3d increment(0.5, -0.2, -0.3);
  EXPECT_TRUE(model.noise(3.0 * increment).isApprox(3.0 * model.noise(increment), 1e-14));
}

TEST(HolonomicDrive, RefusesParametersOutOfRange) {
  for (int i = 0; i < 4; ++i) {
    double values[] = {0.0, 0.0, 0.0, 0.0};
    values[i] = -1.0;
    EXPECT_THROW(HolonomicDrive({values[0], values[1], values[2], values[3]}),
                 std::invalid_argument);
  }
}

}  // namespace
}  // namespace ramscout_kinematics
