// SPDX-License-Identifier: BSD-3-Clause
#include "../src/polar_sampling.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr int kSectors = 8;

/// Two rings around the grid's middle: samples at 0.4 and 0.6 m, and at 1.4 and 1.6 m.
PolarSampling sampling(const CellRule& rule = {}) {
  return {{0.4, 0.6, 1.4, 1.6}, {0.1, 0.1}, kSectors, rule};
}

std::vector<PolarGrid::Cell> cellsOf(const ram_slam::LaserScan& scan,
                                     const ram_slam::Pose2& laser_from_grid,
                                     const CellRule& rule = {}) {
  std::vector<PolarGrid::Cell> cells(2 * kSectors);
  sampling(rule).sample(laser_from_grid, scan, cells.data());
  return cells;
}

/// A full turn in which every beam reads the same.
ram_slam::LaserScan circle(float range_m) {
  ram_slam::LaserScan scan;
  scan.stamp_ns = 1;
  scan.angle_min_rad = -M_PI;
  scan.angle_increment_rad = 2.0 * M_PI / 720;
  scan.range_min_m = 0.05F;
  scan.range_max_m = 30.0F;
  scan.ranges_m.assign(720, range_m);
  return scan;
}

TEST(PolarSampling, WithinACircleAllIsFree) {
  for (const PolarGrid::Cell cell : cellsOf(circle(5.0F), {})) EXPECT_EQ(cell, PolarGrid::kFree);
}

TEST(PolarSampling, BehindReadingsNothingIsKnown) {
  const auto cells = cellsOf(circle(1.0F), {});
  for (int sector = 0; sector < kSectors; ++sector) {
    EXPECT_EQ(cells[sector], PolarGrid::kFree);
    EXPECT_EQ(cells[kSectors + sector], PolarGrid::kUnknown);
  }
}

TEST(PolarSampling, OpenSpaceIsFreeAndInvalidReadingsAreUnknown) {
  for (const PolarGrid::Cell cell : cellsOf(circle(std::numeric_limits<float>::infinity()), {}))
    EXPECT_EQ(cell, PolarGrid::kFree);
  for (const PolarGrid::Cell cell : cellsOf(circle(std::numeric_limits<float>::quiet_NaN()), {}))
    EXPECT_EQ(cell, PolarGrid::kUnknown);
}

TEST(PolarSampling, SamplesNearAReadingAreOccupied) {
  // 0.6 m is on the surface, 0.4 m in front of it: half of the samples.
  EXPECT_EQ(cellsOf(circle(0.6F), {})[0], PolarGrid::kMixed);
  CellRule strict;
  strict.mixed_below = 0.4;
  EXPECT_EQ(cellsOf(circle(0.6F), {}, strict)[0], PolarGrid::kOccupied);
  CellRule wide;
  wide.surface_m = 0.25;
  EXPECT_EQ(cellsOf(circle(0.6F), {}, wide)[0], PolarGrid::kOccupied);
}

TEST(PolarSampling, SectorZeroIsCentredOnTheAxis) {
  auto scan = circle(5.0F);
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam)
    if (std::abs(scan.bearing_rad(beam)) < M_PI / 8.0) scan.ranges_m[beam] = 1.0F;
  const auto cells = cellsOf(scan, {});
  EXPECT_EQ(cells[kSectors], PolarGrid::kUnknown);
  EXPECT_EQ(cells[kSectors + 1], PolarGrid::kFree);
  const auto turned = cellsOf(scan, {0.0, 0.0, M_PI / 4.0});  // the axis is now one sector on
  EXPECT_EQ(turned[kSectors], PolarGrid::kFree);
  EXPECT_EQ(turned[2 * kSectors - 1], PolarGrid::kUnknown);
}

TEST(PolarSampling, TurningLaserAndGridTogetherChangesNothing) {
  PolygonWorld room;
  room.add({{-2.0, -3.0}, {4.0, -3.0}, {4.0, 2.0}, {-2.0, 3.0}}, true);
  const ram_slam::Pose2 world_from_grid{3.0, 1.0, 0.4};
  std::vector<PolarGrid::Cell> expected;
  for (const int beams : {0, 1, 200, -333}) {
    const ram_slam::Pose2 world_from_laser{0.0, 0.0, beams * 2.0 * M_PI / 1440};
    ram_slam::Random random(1);
    const auto scan = room.scan(world_from_laser, 0.0, random, 1440, -M_PI, 2.0 * M_PI / 1440);
    const auto cells = cellsOf(scan, world_from_laser.inverse() * world_from_grid);
    if (expected.empty()) expected = cells;
    EXPECT_EQ(cells, expected) << beams;
  }
}

TEST(PolarSampling, OutsideTheFieldOfViewNothingIsKnown) {
  auto scan = circle(5.0F);
  scan.ranges_m.resize(360);  // from -180 degrees to 0
  const auto cells = cellsOf(scan, {});
  EXPECT_EQ(cells[2], PolarGrid::kUnknown);
  EXPECT_EQ(cells[6], PolarGrid::kFree);
}

}  // namespace
}  // namespace ramscout_feature_detector
