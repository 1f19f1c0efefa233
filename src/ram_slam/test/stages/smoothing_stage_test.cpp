// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/smoothing_stage.hpp"

#include <gmock/gmock.h>

#include "room.hpp"

namespace ram_slam {
namespace {

constexpr std::int64_t kPeriodNs = 200'000'000;
constexpr double kStepM = 0.1;  // per period, along x

/// The robot starts in the middle of a room.
MountedScan scanAt(std::int64_t i) {
  return scanInRoom((i + 10) * kPeriodNs, kStepM * static_cast<double>(i));
}

StampedPose2 odometryAt(std::int64_t i) {
  return {scanAt(i).scan.stamp_ns, {kStepM * static_cast<double>(i), 0.0, 0.0}};
}

TEST(SmoothingStage, TakesInEachScanOnceItsOdometryIsThere) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  for (std::int64_t i = 0; i < 10; ++i) {
    stage.add(scanAt(i));
    EXPECT_FALSE(stage.next());
    stage.addOdometry(odometryAt(i));
    const auto step = stage.next();
    ASSERT_TRUE(step);
    EXPECT_EQ(step->stamp_ns, scanAt(i).scan.stamp_ns);
    EXPECT_FALSE(step->correction);  // there is no loop to close
  }
  const Trajectory smoothed = stage.optimize();
  ASSERT_EQ(smoothed.size(), 10u);
  EXPECT_NEAR(smoothed.back().pose.x_m, 9 * kStepM, 0.01);
}

TEST(SmoothingStage, DropsScansThatNeverGetOdometry) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  stage.add(scanAt(0));
  stage.addOdometry(odometryAt(1));
  EXPECT_FALSE(stage.next());
  ASSERT_EQ(stage.drops().total(), 1u);
  EXPECT_EQ(stage.drops().newest().reason, DropReason::kNoOdometry);
}

TEST(SmoothingStage, WithoutAClosureThereIsNothingToUndo) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  EXPECT_FALSE(stage.undoClosure());
}

TEST(SmoothingStage, BeginsAgainWhenTheClockIsSetBack) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  for (const std::int64_t i : {20, 24, 0}) {
    stage.addOdometry(odometryAt(i));
    stage.add(scanAt(i));
    EXPECT_TRUE(stage.next());
  }
  EXPECT_EQ(stage.resetCount(), 1);
  EXPECT_EQ(stage.smoother().keyScans().size(), 1u);
}

}  // namespace
}  // namespace ram_slam
