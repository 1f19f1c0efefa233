// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/scan_synchroniser.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using Odometry = ScanSynchroniserParameters::Odometry;

constexpr std::int64_t kSecond = 1'000'000'000;

MountedScan scanAt(std::int64_t stamp_ns) {
  MountedScan scan;
  scan.scan.stamp_ns = stamp_ns;
  return scan;
}

/// 1 m/s along x.
StampedPose2 odometryAt(std::int64_t stamp_ns) {
  return {stamp_ns, {1e-9 * static_cast<double>(stamp_ns), 0.0, 0.0}};
}

ScanSynchroniser synchroniser(Odometry odometry) {
  ScanSynchroniserParameters parameters;
  parameters.odometry = odometry;
  return ScanSynchroniser(parameters);
}

TEST(ScanSynchroniser, AScanWaitsForOdometryAroundItAndGetsTheInterpolatedPose) {
  ScanSynchroniser scans = synchroniser(Odometry::kOptional);
  scans.add(odometryAt(kSecond));
  scans.add(scanAt(kSecond + 50'000'000));
  EXPECT_FALSE(scans.next());
  scans.add(odometryAt(kSecond + 100'000'000));
  const auto ready = scans.next();
  ASSERT_TRUE(ready && ready->odom_from_base);
  EXPECT_NEAR(ready->odom_from_base->x_m, 1.05, 1e-12);
  EXPECT_FALSE(scans.next());
}

TEST(ScanSynchroniser, TheStampOffsetShiftsWhereOdometryIsTaken) {
  ScanSynchroniser scans = synchroniser(Odometry::kOptional);
  scans.setStampOffset(200'000'000);
  for (std::int64_t i = 0; i <= 3; ++i) scans.add(odometryAt(kSecond + i * 100'000'000));
  scans.add(scanAt(kSecond));
  const auto ready = scans.next();
  ASSERT_TRUE(ready && ready->odom_from_base);
  EXPECT_NEAR(ready->odom_from_base->x_m, 1.2, 1e-12);
}

TEST(ScanSynchroniser, ScansBeforeTheFirstOdometryPassWithoutItOrAreDropped) {
  ScanSynchroniser optional = synchroniser(Odometry::kOptional);
  ScanSynchroniser required = synchroniser(Odometry::kRequired);
  for (ScanSynchroniser* scans : {&optional, &required}) {
    scans->add(scanAt(kSecond));
    scans->add(odometryAt(2 * kSecond));
  }
  const auto ready = optional.next();
  ASSERT_TRUE(ready);
  EXPECT_FALSE(ready->odom_from_base);
  EXPECT_EQ(optional.withoutOdometryCount(), 1u);
  EXPECT_FALSE(required.next());
  EXPECT_EQ(required.withoutOdometryCount(), 0u);
  ASSERT_EQ(required.drops().total(), 1u);
  EXPECT_EQ(required.drops().newest().reason, DropReason::kNoOdometry);
  EXPECT_EQ(required.drops().newest().first_ns, kSecond);
}

TEST(ScanSynchroniser, WithoutOdometryScansAreGivenUpOneAfterTheOther) {
  ScanSynchroniser scans = synchroniser(Odometry::kOptional);
  const auto limit = static_cast<std::int64_t>(ScanSynchroniserParameters{}.max_waiting_scans);
  for (std::int64_t i = 1; i <= limit; ++i) scans.add(scanAt(i * 1'000'000));
  EXPECT_FALSE(scans.next());
  scans.add(scanAt((limit + 1) * 1'000'000));
  const auto ready = scans.next();
  ASSERT_TRUE(ready);
  EXPECT_EQ(ready->scan.stamp_ns, 1'000'000);
  EXPECT_FALSE(scans.next());
}

TEST(ScanSynchroniser, SlowScansAreGivenUpByTime) {
  ScanSynchroniser scans = synchroniser(Odometry::kOptional);
  scans.add(scanAt(kSecond));
  scans.add(scanAt(10 * kSecond));
  EXPECT_FALSE(scans.next());
  scans.add(scanAt(12 * kSecond));
  EXPECT_TRUE(scans.next());
}

TEST(ScanSynchroniser, AtTheEndTheNewestOdometryHoldsForHalfASecond) {
  ScanSynchroniser scans = synchroniser(Odometry::kOptional);
  scans.add(odometryAt(kSecond));
  scans.add(scanAt(kSecond + 400'000'000));
  scans.add(scanAt(kSecond + 600'000'000));
  EXPECT_FALSE(scans.next());
  scans.finish();
  const auto held = scans.next();
  ASSERT_TRUE(held && held->odom_from_base);
  EXPECT_EQ(held->odom_from_base->x_m, 1.0);
  const auto unknown = scans.next();
  ASSERT_TRUE(unknown);
  EXPECT_FALSE(unknown->odom_from_base);
}

TEST(ScanSynchroniser, RepetitionsAndUnusablePosesAreDroppedAndCounted) {
  ScanSynchroniser scans = synchroniser(Odometry::kNone);
  scans.add(scanAt(kSecond));
  scans.add(scanAt(kSecond));
  EXPECT_TRUE(scans.add(odometryAt(kSecond)));
  EXPECT_FALSE(scans.add(odometryAt(kSecond)));
  EXPECT_FALSE(scans.add(StampedPose2{2 * kSecond, {std::nan(""), 0.0, 0.0}}));
  MountedScan crooked = scanAt(2 * kSecond);
  crooked.base_from_laser.x_m = INFINITY;
  scans.add(crooked);
  EXPECT_TRUE(scans.next());
  EXPECT_FALSE(scans.next());
  const std::vector<Drops> all = scans.drops().all();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].reason, DropReason::kNotLater);
  EXPECT_EQ(all[0].count, 2u);
  EXPECT_EQ(all[1].reason, DropReason::kInvalidScan);
  EXPECT_EQ(all[2].reason, DropReason::kInvalidOdometry);
}

TEST(ScanSynchroniser, BeginsAgainWhenTheClockIsSetBack) {
  ScanSynchroniser scans = synchroniser(Odometry::kOptional);
  scans.add(odometryAt(100 * kSecond));
  scans.add(scanAt(101 * kSecond));
  scans.add(odometryAt(kSecond));
  scans.add(scanAt(kSecond));
  EXPECT_EQ(scans.resetCount(), 1);
  const auto ready = scans.next();
  ASSERT_TRUE(ready && ready->odom_from_base);  // the odometry of the new clock was kept
  EXPECT_EQ(ready->scan.stamp_ns, kSecond);
  EXPECT_EQ(ready->odom_from_base->x_m, 1.0);
}

}  // namespace
}  // namespace ram_slam
