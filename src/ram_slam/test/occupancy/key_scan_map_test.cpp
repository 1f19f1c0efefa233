// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/key_scan_map.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

using PoseAtIndex = Pose2 (*)(int);

LaserScan scanAt(std::int64_t stamp_ns) {
  LaserScan scan;
  scan.stamp_ns = stamp_ns;
  scan.angle_min_rad = -1.5;
  scan.angle_increment_rad = 0.01;
  scan.range_max_m = 20.0F;
  for (std::int64_t i = 0; i < 300; ++i) {
    scan.ranges_m.push_back(2.0F + 0.01F * static_cast<float>((i * 37 + stamp_ns) % 300));
  }
  return scan;
}

const Pose2 kBaseFromLaser{0.2, 0.05, 0.1};

/// The estimated pose at stamp 100 k, and where it really was.
Pose2 estimated(int k) {
  return {0.25 * k, 0.0, 0.0};
}
Pose2 corrected(int k) {
  return {0.24 * k, 0.02 * k, 0.04 * k};
}

KeyScanMap mapOfTenScans(PoseAtIndex pose) {
  KeyScanMap map(OccupancyMapperParameters{});
  for (int k = 0; k < 10; ++k) map.add(scanAt(100 * k), pose(k), kBaseFromLaser);
  map.draw();
  return map;
}

/// Interpolated poses differ by rounding, which may decide about single cells.
void expectNearlySameCells(const OccupancyMapper& a, const OccupancyMapper& b) {
  int visited = 0;
  int differing = 0;
  for (int y = -200; y < 200; ++y) {
    for (int x = -200; x < 200; ++x) {
      visited += a.counts(x, y).visits > 0 ? 1 : 0;
      differing += a.counts(x, y) == b.counts(x, y) ? 0 : 1;
    }
  }
  EXPECT_GT(visited, 1000);
  EXPECT_LE(differing, 5);
}

TEST(KeyScanMap, MapsTheFirstScanAndThoseAfterAMotion) {
  KeyScanMap map(OccupancyMapperParameters{});
  EXPECT_TRUE(map.add(scanAt(0), {}, {}));
  EXPECT_FALSE(map.add(scanAt(100), {0.05, 0.0, 0.0}, {}));
  EXPECT_FALSE(map.add(scanAt(200), {0.09, 0.0, 0.04}, {}));
  EXPECT_TRUE(map.add(scanAt(300), {0.11, 0.0, 0.0}, {}));
  EXPECT_TRUE(map.add(scanAt(400), {0.11, 0.0, 0.06}, {}));
  EXPECT_EQ(map.scanCount(), 3u);
}

TEST(KeyScanMap, CorrectedMapEqualsOneDrawnFromTheCorrectedPoses) {
  KeyScanMap map = mapOfTenScans(estimated);
  const KeyScanMap truth = mapOfTenScans(corrected);
  EXPECT_NE(map.mapper().grid().cells, truth.mapper().grid().cells);
  Trajectory trajectory;
  for (int k = 0; k < 10; ++k) trajectory.push_back({100 * k, corrected(k)});
  EXPECT_EQ(map.correct(trajectory), 9);  // the first pose is the same
  map.draw();
  EXPECT_EQ(map.mapper().grid().cells, truth.mapper().grid().cells);
  EXPECT_EQ(map.correct(trajectory), 0);
}

TEST(KeyScanMap, ACorrectedTrajectoryAlsoGivesTheMotionDuringAScan) {
  LaserScan sweep = scanAt(0);
  sweep.time_increment_s = 1e-9;  // 299 ns from the first beam to the last
  KeyScanMap map(OccupancyMapperParameters{});
  map.add(sweep, {}, kBaseFromLaser);
  map.draw();
  const Pose2 base_then{0.5, 0.1, 0.3};
  map.correct({{0, {0.1, 0.0, 0.0}}, {299, base_then}});
  map.draw();
  const Pose2 map_from_laser = Pose2{0.1, 0.0, 0.0} * kBaseFromLaser;
  OccupancyMapper truth{OccupancyMapperParameters{}};
  truth.add(sweep, map_from_laser, map_from_laser.inverse() * base_then * kBaseFromLaser);
  EXPECT_EQ(map.mapper().grid().cells, truth.grid().cells);
}

TEST(KeyScanMap, ScansBetweenThePosesOfATrajectoryAreInterpolated) {
  KeyScanMap map = mapOfTenScans(estimated);
  EXPECT_EQ(map.correct({{0, {0.0, 0.0, M_PI_2}}, {900, {0.0, 2.25, M_PI_2}}}), 10);
  map.draw();
  const KeyScanMap truth = mapOfTenScans([](int k) { return Pose2{0.0, 0.25 * k, M_PI_2}; });
  expectNearlySameCells(map.mapper(), truth.mapper());
}

TEST(KeyScanMap, ScansAfterTheCorrectionMoveRigidlyWithItAndEarlierOnesStay) {
  KeyScanMap map = mapOfTenScans(estimated);
  const Pose2 shift{0.0, 1.0, 0.3};
  EXPECT_EQ(map.correct({{500, shift * estimated(5)}, {600, shift * estimated(6)}}), 5);
  map.draw();
  const KeyScanMap expected = mapOfTenScans([](int k) {
    return k < 5 ? estimated(k) : Pose2{0.0, 1.0, 0.3} * estimated(k);
  });
  expectNearlySameCells(map.mapper(), expected.mapper());
}

TEST(KeyScanMap, KeepsAsManyScansAsItMayAndTheMapOfAll) {
  OccupancyMapperParameters parameters;
  parameters.max_scan_count = 4;
  KeyScanMap map(parameters);
  for (int k = 0; k < 10; ++k) map.add(scanAt(100 * k), estimated(k), kBaseFromLaser);
  map.draw();
  EXPECT_EQ(map.scanCount(), 4u);
  EXPECT_EQ(map.settledCount(), 6u);
  EXPECT_EQ(map.mapper().grid().cells, mapOfTenScans(estimated).mapper().grid().cells);
}

TEST(KeyScanMap, BadTrajectoriesAndLateScansAreRefusedAndChangeNothing) {
  KeyScanMap map = mapOfTenScans(estimated);
  const std::uint64_t revision = map.mapper().revision();
  EXPECT_THROW(map.correct({{900, {}}, {0, {}}}), std::invalid_argument);
  EXPECT_THROW(map.correct({{0, {std::nan(""), 0.0, 0.0}}}), std::invalid_argument);
  EXPECT_THROW(map.add(scanAt(900), {5.0, 0.0, 0.0}, {}), std::invalid_argument);
  EXPECT_EQ(map.correct({}), 0);
  map.draw();
  EXPECT_EQ(map.mapper().revision(), revision);
}

TEST(KeyScanMap, ScansThatCannotBeDrawnWhereTheyBelongStayWhereTheyWere) {
  KeyScanMap map = mapOfTenScans(estimated);
  const std::uint64_t revision = map.mapper().revision();
  EXPECT_EQ(map.correct({{0, {9e6, 0.0, 0.0}}, {900, {9e6, 0.0, 0.0}}}), 10);
  int failures = 0;
  map.draw([&](std::int64_t, const std::exception&) { ++failures; });
  EXPECT_EQ(failures, 10);
  EXPECT_EQ(map.scanCount(), 10u);
  EXPECT_EQ(map.mapper().revision(), revision);
  EXPECT_EQ(map.draw().hit, 0);
}

TEST(KeyScanMap, ScanWhosePoseChangesBeforeItIsDrawnIsDrawnOnce) {
  KeyScanMap map(OccupancyMapperParameters{});
  map.add(scanAt(100), {}, {});
  EXPECT_EQ(map.mapper().grid().width, 0);
  map.correct({{100, {0.001, 0.0, 0.0}}, {200, {0.001, 0.0, 0.0}}});  // less than a correction
  map.draw();
  KeyScanMap truth(OccupancyMapperParameters{});
  truth.add(scanAt(100), {0.001, 0.0, 0.0}, {});
  truth.draw();
  EXPECT_EQ(map.mapper().grid().cells, truth.mapper().grid().cells);
}

TEST(KeyScanMap, WithoutItsNewestScansIsAsItWasBefore) {
  KeyScanMap before(OccupancyMapperParameters{});
  for (int k = 0; k < 6; ++k) before.add(scanAt(100 * k), estimated(k), kBaseFromLaser);
  before.draw();
  KeyScanMap map = mapOfTenScans(estimated);
  EXPECT_EQ(map.removeAfter(500), 4);
  EXPECT_EQ(map.scanCount(), 6u);
  EXPECT_EQ(map.mapper().grid().cells, before.mapper().grid().cells);
  EXPECT_EQ(map.removeAfter(500), 0);
  EXPECT_TRUE(map.add(scanAt(600), estimated(7), kBaseFromLaser));
}

TEST(KeyScanMap, ContinuesAMapOfWhichItWasGivenTheScans) {
  const KeyScanMap whole = mapOfTenScans(estimated);
  KeyScanMap first(OccupancyMapperParameters{});
  for (int k = 0; k < 5; ++k) first.add(scanAt(100 * k), estimated(k), kBaseFromLaser);
  first.draw();
  KeyScanMap second(OccupancyMapperParameters{}, first.scans());
  EXPECT_EQ(second.mapper().grid().cells, first.mapper().grid().cells);
  for (int k = 5; k < 10; ++k) second.add(scanAt(100 * k), estimated(k), kBaseFromLaser);
  second.draw();
  EXPECT_EQ(second.mapper().grid().cells, whole.mapper().grid().cells);
  EXPECT_EQ(second.scans().size(), 10u);
  EXPECT_EQ(second.scans()[3].map_from_laser.x_m, whole.scans()[3].map_from_laser.x_m);
}

TEST(KeyScanMap, LeavesLoadedScansWhereTheyAre) {
  const std::vector<PlacedScan> loaded = mapOfTenScans(estimated).scans();
  KeyScanMap map(OccupancyMapperParameters{}, loaded);
  Trajectory trajectory;
  for (int k = 0; k < 10; ++k) trajectory.push_back({100 * k, corrected(k)});
  EXPECT_EQ(map.correct(trajectory), 0);
  EXPECT_EQ(map.removeAfter(0), 0);
  EXPECT_EQ(map.scans().size(), 10u);
}

}  // namespace
}  // namespace ram_slam
