// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/map_quality.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

using ram_slam::kFreeCell;
using ram_slam::kOccupiedCell;
using ram_slam::OccupancyGrid;
using ram_slam::Pose2;

OccupancyGrid emptyMap(int width, int height) {
  OccupancyGrid map;
  map.width = width;
  map.height = height;
  map.cells.assign(map.index(0, height), ram_slam::kUnknownCell);
  return map;
}

void fill(OccupancyGrid& map, int x0, int y0, int x1, int y1, std::int8_t value) {
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) map.cells[map.index(x, y)] = value;
  }
}

/// A room of 80 x 40 free cells with walls one cell thick, in a map of 100 x 60 cells.
OccupancyGrid room() {
  OccupancyGrid map = emptyMap(100, 60);
  fill(map, 9, 9, 91, 51, kOccupiedCell);
  fill(map, 10, 10, 90, 50, kFreeCell);
  return map;
}

TEST(CompareMaps, MapAgreesWithItself) {
  const MapAgreement agreement = compareMaps(room(), room(), {});
  EXPECT_EQ(agreement.occupied_iou, 1.0);
  EXPECT_EQ(agreement.free_iou, 1.0);
  EXPECT_EQ(agreement.coverage, 1.0);
  EXPECT_EQ(agreement.wall_distance_m.max, 0.0);
  EXPECT_EQ(agreement.wall_distance_m.count, 244u);
}

TEST(CompareMaps, SameRoomInAnotherFrameAgrees) {
  OccupancyGrid moved = room();
  moved.map_from_grid = {-7.0, 3.0, 0.0};
  EXPECT_EQ(compareMaps(moved, room(), {7.0, -3.0, 0.0}).occupied_iou, 1.0);
  const MapAgreement turned =
      compareMaps(moved, room(), Pose2{0.0, 0.0, 0.01} * Pose2{7.0, -3.0, 0.0});
  EXPECT_GT(turned.wall_distance_m.mean, 0.005);
  EXPECT_LT(turned.wall_distance_m.max, 0.10);
}

TEST(CompareMaps, ShiftByOneCellIsForgivenAndByFourIsNot) {
  EXPECT_EQ(compareMaps(room(), room(), {0.05, 0.0, 0.0}).occupied_iou, 1.0);
  const MapAgreement agreement = compareMaps(room(), room(), {0.2, 0.0, 0.0});
  // The 80 + 2 cells of both long walls match but for their ends; of the short ones, 40 cells each,
  // none does.
  EXPECT_NEAR(agreement.occupied_iou, 160.0 / (160.0 + 84.0 + 42.0), 0.03);
  EXPECT_NEAR(agreement.wall_distance_m.max, 0.2, 1e-6);
  EXPECT_LT(agreement.free_iou, 1.0);
}

TEST(CompareMaps, WallThatWasNeverSeenIsNotMissed) {
  OccupancyGrid half = room();
  fill(half, 50, 0, 100, 60, ram_slam::kUnknownCell);
  const MapAgreement agreement = compareMaps(half, room(), {});
  EXPECT_GT(agreement.occupied_iou, 0.97);
  EXPECT_EQ(agreement.free_iou, 1.0);
  EXPECT_NEAR(agreement.coverage, 0.5, 0.01);
}

TEST(CompareMaps, InventedAndMissedWallsCount) {
  OccupancyGrid invented = room();
  fill(invented, 30, 15, 31, 45, kOccupiedCell);
  EXPECT_NEAR(compareMaps(invented, room(), {}).occupied_iou, 244.0 / (244.0 + 30.0), 1e-9);
  EXPECT_NEAR(compareMaps(room(), invented, {}).occupied_iou, 244.0 / (244.0 + 30.0), 1e-9);
}

TEST(CompareMaps, NothingToCompareIsRefused) {
  EXPECT_THROW(compareMaps(room(), emptyMap(10, 10), {}), std::invalid_argument);
  EXPECT_THROW(compareMaps(OccupancyGrid{}, room(), {}), std::invalid_argument);
}

TEST(FindDoubledWalls, RoomHasNone) {
  const DoubledWalls doubled = findDoubledWalls(room());
  EXPECT_EQ(doubled.occupied_count, 244u);
  EXPECT_EQ(doubled.fraction, 0.0);
}

TEST(FindDoubledWalls, WallSeenTwiceIsFoundAtTwoToSixCells) {
  for (const int gap : {2, 4, 6}) {
    OccupancyGrid map = room();
    fill(map, 10, 9 + gap, 90, 10 + gap, kOccupiedCell);
    const DoubledWalls doubled = findDoubledWalls(map);
    EXPECT_NEAR(doubled.fraction, 160.0 / 324.0, 0.05) << gap;
    EXPECT_NEAR(doubled.fraction_across_free, doubled.fraction, 1e-12) << gap;
  }
  OccupancyGrid map = room();
  fill(map, 10, 17, 90, 18, kOccupiedCell);  // 8 cells away: a narrow passage
  EXPECT_EQ(findDoubledWalls(map).fraction, 0.0);
}

TEST(FindDoubledWalls, TwoSidesOfOneWallHaveNothingFreeBetween) {
  OccupancyGrid map = emptyMap(100, 60);
  fill(map, 5, 5, 95, 28, kFreeCell);
  fill(map, 5, 28, 95, 29, kOccupiedCell);
  fill(map, 5, 31, 95, 32, kOccupiedCell);
  fill(map, 5, 32, 95, 55, kFreeCell);
  const DoubledWalls doubled = findDoubledWalls(map);
  EXPECT_GT(doubled.fraction, 0.9);
  EXPECT_EQ(doubled.fraction_across_free, 0.0);
}

TEST(FindDoubledWalls, SlantedWallsAreFound) {
  OccupancyGrid map = emptyMap(200, 200);
  fill(map, 0, 0, 200, 200, kFreeCell);
  for (int x = 0; x < 150; ++x) {
    const int y = static_cast<int>(std::floor(20.0 + 0.5 * x));
    map.cells[map.index(x, y)] = kOccupiedCell;
  }
  EXPECT_EQ(findDoubledWalls(map).fraction, 0.0);
  for (int x = 0; x < 150; ++x) {
    const int y = static_cast<int>(std::floor(25.0 + 0.5 * x));
    map.cells[map.index(x, y)] = kOccupiedCell;
  }
  EXPECT_GT(findDoubledWalls(map).fraction, 0.9);
}

}  // namespace
}  // namespace ramscout_bringup
