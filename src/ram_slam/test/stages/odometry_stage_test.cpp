// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/odometry_stage.hpp"

#include <gmock/gmock.h>

#include "room.hpp"

namespace ram_slam {
namespace {

constexpr std::int64_t kPeriodNs = 100'000'000;
constexpr double kStepM = 0.05;  // per period, along x

/// The robot starts in the middle of a room.
MountedScan scanAt(std::int64_t i) {
  return scanInRoom((i + 10) * kPeriodNs, kStepM * static_cast<double>(i));
}

/// Wheels that go ten per cent too far.
StampedPose2 wheelsAt(std::int64_t i) {
  return {(i + 10) * kPeriodNs, {1.1 * kStepM * static_cast<double>(i), 0.0, 0.0}};
}

TEST(OdometryStage, ScansCorrectTheWheels) {
  OdometryStage stage{LaserOdometryParameters{}};
  std::optional<OdometryStep> last;
  for (std::int64_t i = 0; i < 20; ++i) {
    stage.add(scanAt(i));
    EXPECT_FALSE(stage.next());
    EXPECT_TRUE(stage.addWheels(wheelsAt(i)));
    last = stage.next();
    ASSERT_TRUE(last);
    EXPECT_EQ(last->scan.scan.stamp_ns, wheelsAt(i).stamp_ns);
  }
  EXPECT_NEAR(last->estimate.odom_from_base.pose.x_m, 19 * kStepM, 0.01);
  EXPECT_EQ(stage.drops().total(), 0u);
}

TEST(OdometryStage, PassesTheWheelsAsTheyAreIfAskedTo) {
  OdometryStage stage(LaserOdometryParameters{}, false);
  for (std::int64_t i = 0; i < 3; ++i) {
    stage.add(scanAt(i));
    stage.addWheels(wheelsAt(i));
    EXPECT_EQ(stage.next()->estimate.odom_from_base.pose.x_m, wheelsAt(i).pose.x_m);
  }
}

TEST(OdometryStage, WithoutWheelsScansAloneGiveTheMotion) {
  LaserOdometryParameters parameters;
  parameters.use_wheels = false;
  OdometryStage stage(parameters);
  std::optional<OdometryStep> last;
  for (std::int64_t i = 0; i < 20; ++i) {
    stage.add(scanAt(i));
    last = stage.next();
    ASSERT_TRUE(last);
  }
  EXPECT_NEAR(last->estimate.odom_from_base.pose.x_m, 19 * kStepM, 0.01);
  EXPECT_FALSE(stage.hasWheels());
}

TEST(OdometryStage, UnusableScansAreDroppedAndTheNextOnesUsed) {
  OdometryStage stage{LaserOdometryParameters{}};
  stage.addWheels(wheelsAt(0));
  stage.addWheels(wheelsAt(2));
  stage.add(scanAt(0));
  MountedScan empty = scanAt(1);
  empty.scan.ranges_m.clear();
  stage.add(empty);
  stage.add(scanAt(2));
  EXPECT_TRUE(stage.next());
  EXPECT_EQ(stage.next()->scan.scan.stamp_ns, scanAt(2).scan.stamp_ns);
  ASSERT_EQ(stage.drops().total(), 1u);
  EXPECT_EQ(stage.drops().newest().reason, DropReason::kInvalidScan);
}

TEST(OdometryStage, BeginsAgainWhenTheClockIsSetBack) {
  OdometryStage stage{LaserOdometryParameters{}};
  for (std::int64_t i = 30; i < 35; ++i) {
    stage.add(scanAt(i));
    stage.addWheels(wheelsAt(i));
    ASSERT_TRUE(stage.next());
  }
  stage.add(scanAt(0));
  stage.addWheels(wheelsAt(0));
  const auto first = stage.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->estimate.odom_from_base.pose.x_m, 0.0);
  EXPECT_EQ(stage.resetCount(), 1);
}

}  // namespace
}  // namespace ram_slam
