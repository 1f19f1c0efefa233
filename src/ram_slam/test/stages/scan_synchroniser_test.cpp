// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/scan_synchroniser.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

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

TEST(ScanSynchroniser, GivesTheSameForEveryInterleavingOfScansAndOdometry) {
  // Scans and odometry each keep their order; how they interleave is sampled.
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    ScanSynchroniser scans = synchroniser(Odometry::kOptional);
    std::vector<SynchronisedScan> given;
    const auto take = [&] {
      while (auto ready = scans.next()) given.push_back(std::move(*ready));
    };
    std::int64_t next_scan = 0;
    std::int64_t next_odometry = 0;
    while (next_scan < 30 || next_odometry < 20) {
      const bool takes_scan = next_odometry == 20 || (next_scan < 30 && random.uniform() < 0.6);
      if (takes_scan) {
        scans.add(scanAt(kSecond + 70'000'000 * next_scan++));
      } else {
        scans.add(odometryAt(kSecond + 100'000'000 * next_odometry++));
      }
      take();
    }
    scans.finish();
    take();
    ASSERT_EQ(given.size(), 30u) << seed;
    for (std::size_t i = 0; i < given.size(); ++i) {
      EXPECT_EQ(given[i].scan.stamp_ns, kSecond + 70'000'000 * static_cast<std::int64_t>(i));
      ASSERT_TRUE(given[i].odom_from_base) << seed << " " << i;
      const double at_s = 1e-9 * static_cast<double>(given[i].scan.stamp_ns);
      EXPECT_NEAR(given[i].odom_from_base->x_m, std::min(at_s, 2.9), 1e-9);  // held from 2.9 s on
    }
    EXPECT_EQ(scans.drops().total(), 0u);
  }
}

TEST(ScanSynchroniser, ForgetsTheOldestOdometryBeyondWhatItMayKeep) {
  ScanSynchroniserParameters parameters;
  parameters.max_odometry_readings = 3;
  ScanSynchroniser scans(parameters);
  for (std::int64_t i = 1; i <= 5; ++i) scans.add(odometryAt(i * kSecond));
  scans.add(scanAt(2 * kSecond));
  scans.add(scanAt(3 * kSecond));
  EXPECT_FALSE(scans.next()->odom_from_base);
  EXPECT_DOUBLE_EQ(scans.next()->odom_from_base->x_m, 3.0);
}

TEST(ScanSynchroniser, WithoutOdometryToWaitForScansPassAtOnce) {
  ScanSynchroniser scans = synchroniser(Odometry::kNone);
  scans.add(odometryAt(kSecond));
  for (std::int64_t i = 1; i <= 3; ++i) {
    scans.add(scanAt(i * kSecond));
    const auto ready = scans.next();
    ASSERT_TRUE(ready);
    EXPECT_EQ(ready->scan.stamp_ns, i * kSecond);
    EXPECT_FALSE(ready->odom_from_base);
  }
  EXPECT_EQ(scans.withoutOdometryCount(), 0u) << "none was waited for";
}

TEST(ScanSynchroniser, ANegativeOffsetTakesEarlierOdometry) {
  ScanSynchroniser scans = synchroniser(Odometry::kOptional);
  scans.setStampOffset(-500'000'000);
  scans.add(odometryAt(kSecond));
  scans.add(odometryAt(2 * kSecond));
  scans.add(scanAt(2 * kSecond + 250'000'000));
  EXPECT_NEAR(scans.next()->odom_from_base->x_m, 1.75, 1e-12);
}

TEST(ScanSynchroniser, OdometryWhoseClockIsSetBackBeginsAgainAlone) {
  ScanSynchroniser scans = synchroniser(Odometry::kRequired);
  scans.add(odometryAt(100 * kSecond));
  EXPECT_TRUE(scans.add(odometryAt(kSecond)));
  EXPECT_TRUE(scans.add(odometryAt(2 * kSecond)));
  scans.add(scanAt(kSecond + 500'000'000));
  EXPECT_NEAR(scans.next()->odom_from_base->x_m, 1.5, 1e-12);
  EXPECT_EQ(scans.resetCount(), 0) << "no scan was of the other clock";
}

TEST(ScanSynchroniser, ScansThatWaitAreForgottenWithTheirClock) {
  ScanSynchroniser scans = synchroniser(Odometry::kNone);
  scans.add(scanAt(100 * kSecond));
  scans.add(scanAt(101 * kSecond));
  scans.add(scanAt(kSecond));
  EXPECT_EQ(scans.next()->scan.stamp_ns, kSecond);
  EXPECT_FALSE(scans.next());
}

}  // namespace
}  // namespace ram_slam
