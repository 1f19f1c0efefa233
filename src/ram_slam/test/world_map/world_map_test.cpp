// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/world_map.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "example_world.hpp"

namespace ram_slam {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(WorldMap, RegionOfOneGridIsItsCells) {
  WorldMap map;
  const LocalOccupancy occupancy = occupancyAt(poseAt(3.0, -2.0), 10, "map");
  map.put(occupancy);
  const MapRegion whole = map.region({3.0, -2.0, 5.0, -0.5});
  EXPECT_EQ(whole.grid.cells, occupancy.grid.cells);
  EXPECT_EQ(whole.grid.width, 4);
  EXPECT_EQ(whole.grid.map_from_grid.x_m, 3.0);
  EXPECT_EQ(whole.grid_stamp_ns, 10);
}

TEST(WorldMap, RegionIsRoundedOutwardsToWholeCells) {
  WorldMap map;
  map.put(occupancyAt(poseAt(0.0, 0.0), 10, "map"));
  const OccupancyGrid grid = map.region({0.6, 1.1, 0.9, 1.6}).grid;
  EXPECT_EQ(grid.map_from_grid.x_m, 0.5);
  EXPECT_EQ(grid.map_from_grid.y_m, 1.0);
  EXPECT_EQ(grid.width, 1);
  EXPECT_EQ(grid.height, 2);
  EXPECT_THAT(grid.cells, testing::ElementsAre(kOccupiedCell, kUnknownCell));
}

TEST(WorldMap, RotatedGridIsDrawnWhereItLies) {
  WorldMap map;
  map.put(occupancyAt(poseAt(10.0, 0.0, M_PI_2), 10, "room"));
  // Its cell (1, 2), centre (0.75, 1.25), lies at (10 - 1.25, 0.75).
  const OccupancyGrid grid = map.region({8.5, 0.5, 9.0, 1.0}).grid;
  EXPECT_THAT(grid.cells, testing::ElementsAre(kOccupiedCell));
  EXPECT_THAT(map.region({10.5, 0.5, 11.0, 1.0}).grid.cells, testing::ElementsAre(kUnknownCell));
}

TEST(WorldMap, NewestGridThatKnowsACellTellsIt) {
  WorldMap map;
  LocalOccupancy older = occupancyAt(poseAt(0.0, 0.0), 10, "map");
  LocalOccupancy newer = older;
  newer.frame = "room";
  newer.stamp_ns = 20;
  newer.grid.cells.assign(12, kUnknownCell);
  newer.grid.cells[0] = 60;
  map.put(newer);
  map.put(older);
  std::vector<std::int8_t> expected = older.grid.cells;
  expected[0] = 60;
  EXPECT_EQ(map.region({0.0, 0.0, 2.0, 1.5}).grid.cells, expected);
}

TEST(WorldMap, GridReplacesTheOlderOneOfItsFrame) {
  WorldMap map;
  map.put(occupancyAt(poseAt(0.0, 0.0), 10, "map"));
  map.put(occupancyAt(poseAt(100.0, 0.0), 20, "map"));
  EXPECT_EQ(map.occupancies().size(), 1u);
  EXPECT_THAT(map.region({0.0, 0.0, 0.4, 0.4}).grid.cells, testing::ElementsAre(kUnknownCell));
}

TEST(WorldMap, RegionHoldsTheLandmarksInsideAndTheBlocksBetweenThem) {
  const LandmarkLayer inside = exampleWorld().region({-0.5, -0.5, 2.0, 2.0}).landmarks;
  ASSERT_EQ(inside.landmarks.size(), 2u);
  EXPECT_EQ(inside.landmarks[0].id, 1u);
  EXPECT_EQ(inside.landmarks[1].id, 4u);
  ASSERT_EQ(inside.cross_covariances.size(), 1u);
  EXPECT_EQ(inside.cross_covariances[0].covariance_m2,
            exampleLandmarks().cross_covariances[0].covariance_m2);
  EXPECT_EQ(inside.stamp_ns, 1234);
}

TEST(WorldMap, RegionHoldsThePointsInside) {
  const WorldMap map = exampleWorld();  // points at (1, 1) and, turned around, at (-1, 1)
  const MapRegion region = map.region({0.5, 0.5, 1.5, 1.5});
  ASSERT_EQ(region.clouds.size(), 1u);
  ASSERT_EQ(region.clouds[0].points.size(), 1u);
  EXPECT_EQ(region.clouds[0].points[0].rgb, 0xff0000U);
  EXPECT_EQ(map.region({-1.5, 0.5, -0.5, 1.5}).clouds[0].points[0].rgb, 0x00ff00U);
  EXPECT_TRUE(map.region({20.0, 20.0, 21.0, 21.0}).clouds.empty());
}

TEST(WorldMap, ARegionAmongTensOfThousandsOfGridsIsGivenAtOnce) {
  WorldMap map;
  for (int i = 0; i < 5000; ++i)
    map.put(occupancyAt(poseAt(1000.0 + i, 0.0), 10, "far" + std::to_string(i)));
  map.put(occupancyAt(poseAt(0.0, 0.0), 20, "here"));
  const auto start = std::chrono::steady_clock::now();
  const OccupancyGrid grid = map.region({-100.0, -100.0, 100.0, 100.0}).grid;
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(500));
  EXPECT_EQ(grid.width, 400);
  EXPECT_EQ(std::count(grid.cells.begin(), grid.cells.end(), kUnknownCell), 400 * 400 - 12);
}

TEST(WorldMap, EmptyMapHasEmptyRegions) {
  const WorldMap map;
  EXPECT_TRUE(map.empty());
  const MapRegion region = map.region({0.0, 0.0, 1.0, 1.0});
  EXPECT_TRUE(region.grid.cells.empty());
  EXPECT_TRUE(region.landmarks.landmarks.empty());
}

TEST(WorldMap, RefusesBoxesThatAreNoneOrTooLarge) {
  const WorldMap map = exampleWorld();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(map.region({0.0, 0.0, 0.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(map.region({0.0, 1.0, 1.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(map.region({0.0, 0.0, kNan, 1.0}), std::invalid_argument);
  EXPECT_THROW(map.region({0.0, 0.0, infinity, 1.0}), std::invalid_argument);
  EXPECT_THROW(map.region({-1e6, -1e6, 1e6, 1e6}), std::length_error);
  EXPECT_THROW(map.region({-1e300, 0.0, 1e300, 0.1}), std::length_error);
}

/// Bad parts, each made from a good one by one change.
TEST(WorldMap, RefusesBadPartsAndStaysAsItWas) {
  WorldMap map = exampleWorld();
  const auto refuses = [&map](auto part, const auto& spoil) {
    map.put(part);
    spoil(part);
    EXPECT_THROW(map.put(part), std::invalid_argument);
  };
  const LocalOccupancy occupancy = occupancyAt(poseAt(0.0, 0.0), 10, "map");
  refuses(occupancy, [](auto& part) { part.frame.clear(); });
  refuses(occupancy, [](auto& part) { part.grid.resolution_m = 0.0; });
  refuses(occupancy, [](auto& part) { part.grid.resolution_m = kNan; });
  refuses(occupancy, [](auto& part) { part.grid.cells.pop_back(); });
  refuses(occupancy, [](auto& part) { part.grid.width = -4, part.grid.height = -3; });
  refuses(occupancy, [](auto& part) { part.grid.cells[3] = 101; });
  refuses(occupancy, [](auto& part) { part.grid.map_from_grid.x_m = kNan; });
  refuses(occupancy, [](auto& part) { part.map_from_frame.position_m.x() = kNan; });
  refuses(occupancy, [](auto& part) { part.map_from_frame.orientation.coeffs().setZero(); });
  refuses(exampleLandmarks(), [](auto& part) { part.landmarks[1].id = 1; });
  refuses(exampleLandmarks(), [](auto& part) { part.landmarks[1].pose.covariance(3, 3) = kNan; });
  refuses(exampleLandmarks(), [](auto& part) { part.landmarks[1].existence_log_odds = kNan; });
  refuses(exampleLandmarks(), [](auto& part) { part.landmarks[1].classifier.assign(4097, 'x'); });
  refuses(exampleLandmarks(), [](auto& part) { part.cross_covariances[1].second_id = 8; });
  refuses(exampleLandmarks(),
          [](auto& part) { part.cross_covariances[1] = part.cross_covariances[0]; });
  refuses(exampleLandmarks(), [](auto& part) {
    std::swap(part.cross_covariances[0].first_id, part.cross_covariances[0].second_id);
  });
  refuses(cloudAt(poseAt(1.0, 1.0), "camera"),
          [](auto& part) { part.points[1].z_m = static_cast<float>(kNan); });
  refuses(Trajectory{{1, {}}, {2, {}}}, [](auto& part) { part[1].stamp_ns = 1; });
  EXPECT_EQ(map.occupancies().size(), 2u);
  EXPECT_EQ(map.landmarks().landmarks.size(), 3u);
  EXPECT_EQ(map.trajectory().size(), 2u);
}

TEST(WorldMap, RefusesScansThatAreOfNoUse) {
  WorldMap map;
  PlacedScan no_readings = placedScan(1, 0.0);
  no_readings.scan.ranges_m.clear();
  EXPECT_THROW(map.put(std::vector<PlacedScan>{no_readings}), std::invalid_argument);
  PlacedScan nowhere = placedScan(1, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(map.put(std::vector<PlacedScan>{nowhere}), std::invalid_argument);
  EXPECT_TRUE(map.empty());
}

}  // namespace
}  // namespace ram_slam
