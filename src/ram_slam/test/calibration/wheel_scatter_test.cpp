// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/wheel_scatter.hpp"

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

const MotionNoise kStated{0.01, 0.005, 0.1, 0.1, 0.1};
const Pose2 kStraight{0.3, 0.0, 0.0};
const Pose2 kTurn{0.0, 0.0, 0.3};
constexpr double kScansRad = 0.001;

double statedYaw(const Pose2& motion) {
  return kStated.deviations(motion).z();
}

/// Shares of the stated deviations after intervals of wheels that scatter by `sigma_rad`.
WheelScatter learnedFrom(const Pose2& motion, double sigma_rad, int count) {
  WheelScatter scatter;
  Random random(7);
  for (int i = 0; i < count; ++i)
    scatter.add(motion, motion.yaw_rad + sigma_rad * random.gaussian(), kStated, kScansRad);
  return scatter;
}

TEST(WheelScatter, IsAsStatedBeforeAnythingWasObserved) {
  EXPECT_DOUBLE_EQ(WheelScatter().of(kStated).deviation_rad_per_m, kStated.deviation_rad_per_m);
  EXPECT_DOUBLE_EQ(WheelScatter().of(kStated).deviation_rad_per_rad, kStated.deviation_rad_per_rad);
}

TEST(WheelScatter, OfGoodWheelsIsLearnedWhileTheDistanceStaysAsStated) {
  const MotionNoise believed = learnedFrom(kStraight, 0.6 * statedYaw(kStraight), 2000).of(kStated);
  EXPECT_NEAR(believed.deviation_rad_per_m, 0.6 * kStated.deviation_rad_per_m, 0.01);
  EXPECT_NEAR(believed.rest_deviation_rad, 0.6 * kStated.rest_deviation_rad, 0.001);
  EXPECT_EQ(believed.deviation_m_per_m, kStated.deviation_m_per_m);
  EXPECT_EQ(believed.deviation_rad_per_rad, kStated.deviation_rad_per_rad);
}

TEST(WheelScatter, OfTurnsIsLearnedFromTurns) {
  const MotionNoise believed = learnedFrom(kTurn, 0.5 * statedYaw(kTurn), 2000).of(kStated);
  EXPECT_NEAR(believed.deviation_rad_per_rad, 0.5 * kStated.deviation_rad_per_rad, 0.01);
  EXPECT_EQ(believed.deviation_rad_per_m, kStated.deviation_rad_per_m);
}

TEST(WheelScatter, IsNeverBelowTheLeastShareNorAboveWhatIsStated) {
  const double least = WheelScatterParameters().min_share;
  EXPECT_NEAR(learnedFrom(kStraight, 0.0, 5000).of(kStated).deviation_rad_per_m,
              least * kStated.deviation_rad_per_m, 1e-9);
  EXPECT_NEAR(learnedFrom(kStraight, 1.0, 5000).of(kStated).deviation_rad_per_m,
              kStated.deviation_rad_per_m, 0.01);
}

TEST(WheelScatter, GrowsWithSlips) {
  WheelScatter scatter = learnedFrom(kStraight, 0.0, 5000);
  const double before = scatter.of(kStated).deviation_rad_per_m;
  for (int i = 0; i < 100; ++i) scatter.addSlip();
  EXPECT_GT(scatter.of(kStated).deviation_rad_per_m, 1.4 * before);
}

TEST(WheelScatter, IsNotLearnedWhereScansShowLittle) {
  WheelScatter scatter;
  for (int i = 0; i < 1000; ++i) scatter.add(kStraight, 0.0, kStated, 2.0 * statedYaw(kStraight));
  EXPECT_EQ(scatter.of(kStated).deviation_rad_per_m, kStated.deviation_rad_per_m);
}

}  // namespace
}  // namespace ram_slam
