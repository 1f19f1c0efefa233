// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/motion/motion_noise.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

MotionNoise someNoise() {
  MotionNoise noise;
  noise.rest_deviation_m = 0.1;
  noise.rest_deviation_rad = 0.2;
  noise.deviation_m_per_m = 0.01;
  noise.deviation_rad_per_m = 0.02;
  noise.deviation_rad_per_rad = 0.5;
  return noise;
}

TEST(MotionNoise, IsThatOfRestWithoutMotion) {
  EXPECT_TRUE(someNoise().deviations({}).isApprox(Eigen::Vector3d(0.1, 0.1, 0.2)));
}

TEST(MotionNoise, GrowsWithDistanceAndTurnWhateverTheirSigns) {
  const Eigen::Vector3d wanted(0.1 + 0.01 * 5.0, 0.1 + 0.01 * 5.0, 0.2 + 0.02 * 5.0 + 0.5 * 0.4);
  EXPECT_TRUE(someNoise().deviations({3.0, 4.0, 0.4}).isApprox(wanted));
  EXPECT_TRUE(someNoise().deviations({-3.0, 4.0, -0.4}).isApprox(wanted));
}

TEST(MotionNoise, InformationIsTheInverseOfTheCovariance) {
  const Pose2 motion{1.0, 0.0, 0.3};
  const Eigen::Matrix3d covariance = someNoise().deviations(motion).cwiseAbs2().asDiagonal();
  EXPECT_TRUE((someNoise().information(motion) * covariance).isIdentity(1e-12));
}

TEST(MotionNoise, RefusesADeviationOfZero) {
  MotionNoise noise;
  noise.rest_deviation_rad = 0.0;
  EXPECT_THROW(MotionNoise::table().check(noise), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
