// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/smoothing_stage.hpp"

#include <algorithm>
#include <stdexcept>

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

TEST(SmoothingStage, GivesThePoseInTheMapAtEachKeyScan) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  std::size_t key_scan_count = 0;
  for (std::int64_t i = 0; i < 20; ++i) {
    stage.add(scanAt(i));
    // Wheels that drive two per cent too far.
    stage.addOdometry({odometryAt(i).stamp_ns, {1.02 * kStepM * static_cast<double>(i), 0.0, 0.0}});
    const auto step = stage.next();
    ASSERT_TRUE(step);
    const bool is_key_scan = stage.smoother().keyScans().size() > key_scan_count;
    key_scan_count = stage.smoother().keyScans().size();
    ASSERT_EQ(step->map_from_base.has_value(), is_key_scan);
    if (!is_key_scan) continue;
    EXPECT_NEAR(step->map_from_base->x_m, kStepM * static_cast<double>(i), 0.01);
  }
  EXPECT_GT(key_scan_count, 4u);
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

TEST(SmoothingStage, DropsUnusableScansAndTakesTheNextOnes) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  MountedScan empty = scanAt(0);
  empty.scan.ranges_m.clear();
  stage.add(empty);
  stage.addOdometry(odometryAt(0));
  EXPECT_FALSE(stage.next());
  ASSERT_EQ(stage.drops().total(), 1u);
  EXPECT_EQ(stage.drops().newest().reason, DropReason::kInvalidScan);
  stage.add(scanAt(1));
  stage.addOdometry(odometryAt(1));
  EXPECT_TRUE(stage.next());
  EXPECT_EQ(stage.smoother().keyScans().size(), 1u);
}

TEST(SmoothingStage, KeepsTheMotionOfTheOdometryWhileThereIsNoClosure) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  for (std::int64_t i = 0; i < 12; ++i) {
    stage.add(scanAt(i));
    stage.addOdometry(odometryAt(i));
    ASSERT_TRUE(stage.next());
  }
  const Trajectory smoothed = stage.optimize();
  ASSERT_EQ(smoothed.size(), 12u);
  for (std::int64_t i = 1; i < 12; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(smoothed[at].stamp_ns, odometryAt(i).stamp_ns);
    const Pose2 step = smoothed[at - 1].pose.inverse() * smoothed[at].pose;
    EXPECT_NEAR(step.x_m, kStepM, 0.01);
    EXPECT_NEAR(step.yaw_rad, 0.0, 0.01);
  }
}

TEST(SmoothingStage, InterpolatesTheOdometryAtTheStampOfTheScan) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  stage.addOdometry(odometryAt(0));
  stage.addOdometry(odometryAt(4));
  for (std::int64_t i = 0; i <= 4; ++i) {
    stage.add(scanAt(i));
    ASSERT_TRUE(stage.next()) << i;
  }
  EXPECT_NEAR(
      stage.optimize().back().pose.x_m - stage.smoother().keyScans().front().map_from_laser.x_m,
      4 * kStepM, 0.01);
}

TEST(SmoothingStage, RefusesParametersOutOfTheirBounds) {
  MapSmootherParameters parameters;
  parameters.optimize_period_s = -1.0;
  EXPECT_THROW(SmoothingStage(parameters, {}), std::invalid_argument);
}

TEST(SmoothingStage, GoesOnWhileTheEstimatorIsLost) {
  SmoothingStage stage(MapSmootherParameters{}, {});
  for (std::int64_t i = 0; i < 12; ++i) {
    const std::int64_t stamp_ns = scanAt(i).scan.stamp_ns;
    if (i == 4) stage.set({true, stamp_ns, stamp_ns, {}});
    if (i == 8) stage.set({false, stamp_ns, stamp_ns, {0.8, 1.0, 0.0}});
    stage.addOdometry(odometryAt(i));
    stage.add(scanAt(i));
    EXPECT_TRUE(stage.next());
  }
  EXPECT_EQ(stage.drops().total(), 0u);
  EXPECT_NEAR(stage.smoother().trajectory().back().pose.y_m, 0.0, 0.01);
  // The robot may have been carried when it came to be lost.
  const std::vector<KeyScan>& keys = stage.smoother().keyScans();
  const auto jump =
      std::find_if(keys.begin(), keys.end(), [](const KeyScan& key) { return key.may_be_jump; });
  ASSERT_NE(jump, keys.end());
  EXPECT_GT(jump->stamp_ns, scanAt(4).scan.stamp_ns);
  EXPECT_FALSE(jump->is_jump);
}

TEST(SmoothingStage, ContinuesALoadedMapOnceTheRobotIsFoundInIt) {
  std::vector<PlacedScan> map;
  for (std::int64_t i = 0; i < 10; ++i) map.push_back({scanAt(i).scan, {}, odometryAt(i).pose, {}});
  SmoothingStage stage(MapSmootherParameters{}, {}, map);
  EXPECT_GE(stage.smoother().keyScans().size(), 3u);
  const auto feed = [&stage](std::int64_t i) {
    stage.addOdometry({scanAt(i).scan.stamp_ns, Pose2{5.0, 3.0, 1.0} * odometryAt(i).pose});
    stage.add(scanAt(i));
    return stage.next().has_value();
  };
  EXPECT_FALSE(feed(0));
  EXPECT_FALSE(feed(1));
  const std::int64_t found_ns = scanAt(1).scan.stamp_ns;
  stage.set({false, found_ns, found_ns, odometryAt(1).pose});
  for (std::int64_t i = 2; i < 10; ++i) EXPECT_TRUE(feed(i));
  const Trajectory smoothed = stage.smoother().trajectory();
  ASSERT_EQ(smoothed.size(), 8u);
  EXPECT_NEAR(smoothed.front().pose.x_m, 0.2, 0.02);
  EXPECT_NEAR(smoothed.back().pose.x_m, 0.9, 0.02);
  EXPECT_NEAR(smoothed.back().pose.y_m, 0.0, 0.02);
}

}  // namespace
}  // namespace ram_slam
