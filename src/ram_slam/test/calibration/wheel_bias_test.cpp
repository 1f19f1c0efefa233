// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/wheel_bias.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

/// The motion by wheels that are `ratio` times too large and of which one is larger than the other.
Pose2 byWheels(const Pose2& truth, double ratio, double yaw_per_m) {
  const Eigen::Vector3d twist = logarithm(truth);
  return exponential({ratio * twist.x(), twist.y(), twist.z() + yaw_per_m * ratio * twist.x()});
}

TEST(WheelBias, IsNoneBeforeAnythingWasObserved) {
  const WheelBias bias;
  const Pose2 motion{0.3, 0.01, 0.1};
  EXPECT_NEAR((bias.corrected(motion).inverse() * motion).translation().norm(), 0.0, 1e-12);
  EXPECT_EQ(bias.distanceRatio(), 1.0);
  EXPECT_EQ(bias.yawPerMetre(), 0.0);
}

TEST(WheelBias, OfWornAndUnequalWheelsIsLearnedWithinSomeMetres) {
  WheelBias bias;
  for (int i = 0; i < 200; ++i) {
    const Pose2 truth = exponential({0.3, 0.0, 0.05 * std::sin(0.3 * i)});
    bias.add(byWheels(truth, 1.03, -0.02), truth);
  }
  EXPECT_NEAR(bias.distanceRatio(), 1.0 / 1.03, 1e-3);
  EXPECT_NEAR(bias.yawPerMetre(), 0.02, 1e-3);
  const Pose2 next = exponential({0.5, 0.0, 0.02});
  const Pose2 error = bias.corrected(byWheels(next, 1.03, -0.02)).inverse() * next;
  EXPECT_LT(error.translation().norm(), 1e-3);
  EXPECT_LT(std::abs(error.yaw_rad), 1e-3);
}

TEST(WheelBias, IsLearnedFromWhatWasMeasuredNotFromWhatRepeatsTheWheels) {
  // In every second interval nothing is measured: what is observed is what was learned before, less
  // a little. By itself that would go on for ever.
  WheelBias bias;
  const Pose2 wheels{0.3, 0.0, 0.0};
  for (int i = 0; i < 500; ++i) {
    bias.add(wheels, {0.3 * 0.98, 0.0, 0.0}, 0.9);
    bias.add(wheels, {0.3 * (bias.distanceRatio() - 0.02), 0.0, 0.0}, 0.0);
  }
  EXPECT_NEAR(bias.distanceRatio(), 0.98, 1e-3);
}

TEST(WheelBias, IsTheSameBackwards) {
  WheelBias bias;
  for (int i = 0; i < 200; ++i) {
    const Pose2 truth = exponential({i % 2 == 0 ? 0.3 : -0.3, 0.0, 0.0});
    bias.add(byWheels(truth, 1.0, -0.02), truth);
  }
  EXPECT_NEAR(bias.yawPerMetre(), 0.02, 1e-3);
}

TEST(WheelBias, IsNotTakenFromNoiseNorFromTurns) {
  WheelBias bias;
  Random random(1);
  for (int i = 0; i < 400; ++i) {
    bias.add(exponential({0.3, 0.0, 0.01 * random.gaussian()}), exponential({0.3, 0.0, 0.0}));
    bias.add(exponential({0.1, 0.0, 0.5}), exponential({0.1, 0.0, 0.4}));
  }
  EXPECT_NEAR(bias.yawPerMetre(), 0.0, 0.01);
  EXPECT_EQ(bias.distanceRatio(), 1.0);
}

TEST(WheelBias, FollowsWheelsThatChange) {
  WheelBias bias;
  const Pose2 truth = exponential({0.3, 0.0, 0.0});
  for (int i = 0; i < 1000; ++i) bias.add(byWheels(truth, 1.0, 0.02), truth);
  for (int i = 0; i < 1000; ++i) bias.add(byWheels(truth, 1.0, -0.02), truth);
  EXPECT_NEAR(bias.yawPerMetre(), 0.02, 1e-3);
}

}  // namespace
}  // namespace ram_slam
