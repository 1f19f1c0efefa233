// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/smoothing_stage.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr std::int64_t kPeriodNs = 200'000'000;
constexpr double kStepM = 0.1;  // per period, along x

/// In a room of 10 m by 6 m; the robot starts in its middle.
MountedScan scanAt(std::int64_t i) {
  MountedScan scan;
  scan.scan.stamp_ns = (i + 10) * kPeriodNs;
  scan.scan.angle_min_rad = -M_PI;
  scan.scan.angle_increment_rad = M_PI / 180.0;
  scan.scan.range_min_m = 0.1F;
  scan.scan.range_max_m = 20.0F;
  const double x_m = kStepM * static_cast<double>(i);
  for (int beam = 0; beam < 360; ++beam) {
    const double bearing_rad = scan.scan.bearing_rad(beam);
    const double dx = std::cos(bearing_rad);
    const double dy = std::sin(bearing_rad);
    const double to_x = dx > 0.0 ? (5.0 - x_m) / dx : (-5.0 - x_m) / dx;
    const double to_y = dy > 0.0 ? 3.0 / dy : -3.0 / dy;
    scan.scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y)));
  }
  return scan;
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
