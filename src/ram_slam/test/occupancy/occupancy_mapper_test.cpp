// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/occupancy_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

LaserScan singleBeam(float range_m) {
  LaserScan scan;
  scan.angle_increment_rad = 0.01;
  scan.range_min_m = 0.1F;
  scan.range_max_m = 20.0F;
  scan.ranges_m = {range_m};
  return scan;
}

/// A full turn of beams with ranges between 1 and 8 m.
LaserScan randomScan(std::uint64_t seed) {
  LaserScan scan = singleBeam(0.0F);
  Random random(seed);
  scan.angle_min_rad = -M_PI;
  scan.angle_increment_rad = 2.0 * M_PI / 180.0;
  scan.ranges_m.resize(180);
  for (float& range_m : scan.ranges_m) range_m = static_cast<float>(1.0 + 7.0 * random.uniform());
  return scan;
}

Pose2 randomPose(std::uint64_t seed) {
  Random random(seed);
  const double x_m = 20.0 * random.uniform() - 10.0;
  const double y_m = 20.0 * random.uniform() - 10.0;
  return {x_m, y_m, 2.0 * M_PI * random.uniform()};
}

/// What the beams of a scan see in an empty rectangular room centred at the origin.
/// \param last_beam  pose of the laser at the last beam, seen from the first one
LaserScan scanOfRoom(const Pose2& room_from_first,
                     double width_m,
                     double height_m,
                     const Pose2& last_beam = {}) {
  LaserScan scan = randomScan(0);
  scan.angle_increment_rad = 2.0 * M_PI / 720.0;
  scan.ranges_m.resize(720);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const Pose2 room_from_laser =
        room_from_first * interpolate({}, last_beam, static_cast<double>(i) / 719.0);
    const double angle_rad = room_from_laser.yaw_rad + scan.bearing_rad(i);
    const double x_wall_m = std::copysign(width_m / 2.0, std::cos(angle_rad));
    const double y_wall_m = std::copysign(height_m / 2.0, std::sin(angle_rad));
    scan.ranges_m[i] =
        static_cast<float>(std::min((x_wall_m - room_from_laser.x_m) / std::cos(angle_rad),
                                    (y_wall_m - room_from_laser.y_m) / std::sin(angle_rad)));
  }
  return scan;
}

int countCells(const OccupancyGrid& grid, std::int8_t value) {
  return static_cast<int>(std::count(grid.cells.begin(), grid.cells.end(), value));
}

void expectSameGrid(const OccupancyGrid& a, const OccupancyGrid& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.map_from_grid.x_m, b.map_from_grid.x_m);
  EXPECT_EQ(a.map_from_grid.y_m, b.map_from_grid.y_m);
  EXPECT_EQ(a.cells, b.cells);
}

TEST(OccupancyMapper, BeamOfFiveMetresFreesOneHundredCellsAndOccupiesOne) {
  OccupancyMapper mapper(OccupancyMapperParameters{});
  for (const double yaw_rad : {0.0, M_PI_2, M_PI, -M_PI_2}) {
    const Pose2 centre_of_a_cell{0.025, 0.025, yaw_rad};
    EXPECT_EQ(mapper.add(singleBeam(5.0F), centre_of_a_cell).hit, 1);
    EXPECT_EQ(countCells(mapper.grid(), kFreeCell), 100) << yaw_rad;
    EXPECT_EQ(countCells(mapper.grid(), kOccupiedCell), 1) << yaw_rad;
    mapper.remove(singleBeam(5.0F), centre_of_a_cell);
  }
  mapper.add(singleBeam(5.0F), {0.025, 0.025, 0.0});
  EXPECT_EQ(mapper.counts(-1, 0), CellCounts{});
  EXPECT_EQ(mapper.counts(0, 0), (CellCounts{0, 1}));
  EXPECT_EQ(mapper.counts(99, 0), (CellCounts{0, 1}));
  EXPECT_EQ(mapper.counts(100, 0), (CellCounts{1, 1}));
  EXPECT_EQ(mapper.counts(101, 0), CellCounts{});
}

TEST(OccupancyMapper, BeamVisitsExactlyTheCellsThatFineSamplesOfItLieIn) {
  constexpr double kSpacingM = 1e-4;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    OccupancyMapper mapper(OccupancyMapperParameters{});
    const double range_m = static_cast<float>(0.2 + 5.0 * Random(seed, 1).uniform());
    const Pose2 pose = randomPose(seed);
    mapper.add(singleBeam(static_cast<float>(range_m)), pose);
    const auto cellAt = [&](double distance_m) {
      const Eigen::Vector2d point = pose * Eigen::Vector2d(distance_m, 0.0) / 0.05;
      return std::make_pair(static_cast<int>(std::floor(point.x())),
                            static_cast<int>(std::floor(point.y())));
    };
    std::set<std::pair<int, int>> sampled;
    for (double distance_m = 0.0; distance_m < range_m - 0.025; distance_m += kSpacingM) {
      sampled.insert(cellAt(distance_m));
    }
    sampled.erase(
        cellAt(range_m - 0.025));  // the beam does not leave it half a cell before its end
    sampled.insert(cellAt(range_m));
    for (const auto& [x, y] : sampled) {
      EXPECT_EQ(mapper.counts(x, y).visits, 1u) << seed << ": " << x << ", " << y;
    }
    // Besides, there may be a cell whose corner the beam cuts between two samples.
    const OccupancyGrid grid = mapper.grid();
    const int visited = countCells(grid, kFreeCell) + countCells(grid, kOccupiedCell);
    EXPECT_LE(visited - static_cast<int>(sampled.size()), 1) << seed;
  }
}

TEST(OccupancyMapper, ManyBeamsThroughACellAreOneVisitAndAHitWins) {
  OccupancyMapper mapper(OccupancyMapperParameters{});
  LaserScan scan = singleBeam(2.0F);
  scan.angle_min_rad = -0.005;
  scan.angle_increment_rad = 0.001;
  scan.ranges_m = {2.0F, 2.0F, 2.0F, 2.0F, 2.0F, 1.0F, 2.0F, 2.0F, 2.0F, 2.0F, 2.0F};
  mapper.add(scan, {0.025, 0.025, 0.0});
  EXPECT_EQ(mapper.counts(10, 0), (CellCounts{0, 1}));
  EXPECT_EQ(mapper.counts(20, 0), (CellCounts{1, 1}));
  EXPECT_EQ(mapper.counts(40, 0), (CellCounts{1, 1}));
}

/// Pose of the laser at a sweep's last beam, seen from that at its first.
class SweepTest : public testing::TestWithParam<Pose2> {};

TEST_P(SweepTest, RoomHasItsWallsAndItsFloor) {
  constexpr double kWidthM = 10.02;
  constexpr double kHeightM = 8.06;
  OccupancyMapper mapper(OccupancyMapperParameters{});
  for (const Pose2& pose :
       {Pose2{0.31, 0.17, 0.4}, Pose2{-3.2, 2.7, 2.0}, Pose2{3.9, -1.1, -1.0}}) {
    mapper.add(scanOfRoom(pose, kWidthM, kHeightM, GetParam()), pose, GetParam());
  }
  const OccupancyGrid grid = mapper.grid();
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      if (grid.at(x, y) == kUnknownCell) continue;
      const double x_m = std::abs(grid.map_from_grid.x_m + (x + 0.5) * grid.resolution_m);
      const double y_m = std::abs(grid.map_from_grid.y_m + (y + 0.5) * grid.resolution_m);
      const double inside_m = std::min(kWidthM / 2.0 - x_m, kHeightM / 2.0 - y_m);
      EXPECT_GT(inside_m, -0.05);
      if (grid.at(x, y) == kOccupiedCell) {
        EXPECT_LT(inside_m, 0.05) << x_m << ' ' << y_m;
      }
    }
  }
  EXPECT_NEAR(countCells(grid, kFreeCell) * 0.05 * 0.05, kWidthM * kHeightM,
              0.02 * kWidthM * kHeightM);
}

INSTANTIATE_TEST_SUITE_P(AtRestAndMoving,
                         SweepTest,
                         testing::Values(Pose2{}, Pose2{0.05, 0.01, 0.2}, Pose2{0.0, 0.0, -0.3}));

TEST(OccupancyMapper, MotionByWholeCellsMovesTheMapByWholeCells) {
  OccupancyMapperParameters parameters;
  parameters.resolution = 0.0625;  // a power of two: poses moved by whole cells are exact
  OccupancyMapper here(parameters);
  OccupancyMapper there(parameters);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Pose2 pose = randomPose(seed);
    pose.x_m = std::round(pose.x_m * 1024.0) / 1024.0;
    pose.y_m = std::round(pose.y_m * 1024.0) / 1024.0;
    here.add(randomScan(seed), pose);
    there.add(randomScan(seed), {pose.x_m - 300 * 0.0625, pose.y_m + 77 * 0.0625, pose.yaw_rad});
  }
  int visited = 0;
  for (int y = -320; y < 320; ++y) {
    for (int x = -320; x < 320; ++x) {
      EXPECT_EQ(here.counts(x, y), there.counts(x - 300, y + 77));
      visited += here.counts(x, y).visits > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(visited, 10000);
}

TEST(OccupancyMapper, QuarterTurnOfEverythingTurnsTheMap) {
  OccupancyMapper straight(OccupancyMapperParameters{});
  OccupancyMapper turned(OccupancyMapperParameters{});
  const LaserScan scan = scanOfRoom({0.31, 0.17, 0.4}, 6.01, 4.03);
  straight.add(scan, {0.31, 0.17, 0.4});
  turned.add(scan, {-0.17, 0.31, 0.4 + M_PI_2});
  for (int y = -50; y < 50; ++y) {
    for (int x = -70; x < 70; ++x) {
      EXPECT_EQ(straight.counts(x, y), turned.counts(-y - 1, x)) << x << ", " << y;
    }
  }
}

TEST(OccupancyMapper, RemovingRestoresWhatWasThere) {
  OccupancyMapper mapper(OccupancyMapperParameters{});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) mapper.add(randomScan(seed), randomPose(seed));
  const OccupancyGrid before = mapper.grid();
  for (std::uint64_t seed = 6; seed <= 9; ++seed) mapper.add(randomScan(seed), randomPose(seed));
  EXPECT_NE(mapper.grid().cells, before.cells);
  for (std::uint64_t seed = 6; seed <= 9; ++seed) mapper.remove(randomScan(seed), randomPose(seed));
  expectSameGrid(mapper.grid(), before);
  const Pose2 last_beam{0.02, 0.0, 0.1};
  mapper.add(randomScan(6), randomPose(6), last_beam);
  mapper.remove(randomScan(6), randomPose(6), last_beam);
  expectSameGrid(mapper.grid(), before);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) mapper.remove(randomScan(seed), randomPose(seed));
  EXPECT_EQ(mapper.grid().width, 0);
}

TEST(OccupancyMapper, RemovingWhatWasNotAddedIsRefusedAndChangesNothing) {
  OccupancyMapper mapper(OccupancyMapperParameters{});
  mapper.add(randomScan(1), randomPose(1));
  const OccupancyGrid before = mapper.grid();
  EXPECT_THROW(mapper.remove(randomScan(2), randomPose(2)), std::invalid_argument);
  EXPECT_THROW(mapper.remove(randomScan(2), randomPose(1)), std::invalid_argument);
  EXPECT_THROW(mapper.add(randomScan(2), randomPose(2), {0.0, 2e6, 0.0}), std::invalid_argument);
  EXPECT_THROW(mapper.add(randomScan(2), randomPose(2), {0.0, 0.0, kNan}), std::invalid_argument);
  expectSameGrid(mapper.grid(), before);
}

TEST(OccupancyMapper, OrderOfScansDoesNotMatter) {
  OccupancyMapper forward(OccupancyMapperParameters{});
  OccupancyMapper backward(OccupancyMapperParameters{});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    forward.add(randomScan(seed), randomPose(seed));
    backward.add(randomScan(21 - seed), randomPose(21 - seed));
  }
  expectSameGrid(forward.grid(), backward.grid());
}

TEST(OccupancyMapper, RefreshedGridEqualsAWholeNewOne) {
  OccupancyMapper mapper(OccupancyMapperParameters{});
  OccupancyGrid grid = mapper.grid();
  std::uint64_t revision = mapper.revision();
  int part_count = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    if (seed % 7 == 0) {
      mapper.remove(randomScan(seed - 1), randomPose(seed - 1));
    } else {
      mapper.add(randomScan(seed), randomPose(seed));
    }
    const OccupancyGrid old = grid;
    const GridChange change = mapper.refresh(grid, revision);
    revision = mapper.revision();
    expectSameGrid(grid, mapper.grid());
    if (change.whole) continue;
    ++part_count;
    for (int y = 0; y < old.height; ++y) {
      for (int x = 0; x < old.width; ++x) {
        const bool inside = x >= change.x && x < change.x + change.width && y >= change.y &&
                            y < change.y + change.height;
        EXPECT_TRUE(inside || old.at(x, y) == grid.at(x, y));
      }
    }
  }
  EXPECT_GT(part_count, 5);
  EXPECT_EQ(mapper.refresh(grid, revision).width, 0);
}

TEST(OccupancyMapper, ReadingsThatSayNothingChangeNothing) {
  OccupancyMapper mapper(OccupancyMapperParameters{});
  LaserScan scan = singleBeam(0.0F);
  scan.ranges_m = {kNan, -kInfinity, 0.0F, -1.0F, 0.05F, 21.0F, 1e30F, 1e-40F, -0.0F};
  const BeamCounts counts = mapper.add(scan, {0.025, 0.025, 0.0});
  EXPECT_EQ(counts.hit + counts.cleared, 0);
  EXPECT_EQ(counts.too_close, 1);
  EXPECT_EQ(counts.invalid, 8);
  EXPECT_EQ(mapper.grid().width, 0);
}

TEST(OccupancyMapper, NothingInRangeClearsAsFarAsItMay) {
  OccupancyMapperParameters parameters;
  parameters.clear_max_range_m = 2.0;
  OccupancyMapper mapper(parameters);
  EXPECT_EQ(mapper.add(singleBeam(kInfinity), {0.025, 0.025, 0.0}).cleared, 1);
  EXPECT_EQ(countCells(mapper.grid(), kFreeCell), 40);
  EXPECT_EQ(countCells(mapper.grid(), kOccupiedCell), 0);

  parameters.clear_max_range_m = 0.0;
  OccupancyMapper careful(parameters);
  EXPECT_EQ(careful.add(singleBeam(kInfinity), {}).invalid, 1);
  EXPECT_EQ(careful.grid().width, 0);
}

TEST(OccupancyMapper, HitBeyondTheUsableRangeClearsUpToIt) {
  OccupancyMapperParameters parameters;
  parameters.max_range_m = 3.0;
  parameters.clear_max_range_m = 0.0;
  OccupancyMapper mapper(parameters);
  EXPECT_EQ(mapper.add(singleBeam(10.0F), {0.025, 0.025, 0.0}).cleared, 1);
  EXPECT_EQ(countCells(mapper.grid(), kFreeCell), 60);
  EXPECT_EQ(countCells(mapper.grid(), kOccupiedCell), 0);
}

TEST(OccupancyMapper, CellIsOccupiedIfEnoughOfItsVisitsWereHits) {
  OccupancyMapperParameters parameters;
  parameters.occupied_threshold = 0.25;
  parameters.min_visits = 3;
  OccupancyMapper mapper(parameters);
  const Pose2 pose{0.025, 0.025, 0.0};
  const auto valueOfWall = [&] {
    const OccupancyGrid grid = mapper.grid();
    return grid.at(20 + static_cast<int>(std::lround(-grid.map_from_grid.x_m / 0.05)),
                   static_cast<int>(std::lround(-grid.map_from_grid.y_m / 0.05)));
  };
  mapper.add(singleBeam(1.0F), pose);
  mapper.add(singleBeam(2.0F), pose);
  EXPECT_EQ(valueOfWall(), kUnknownCell);
  mapper.add(singleBeam(2.0F), pose);
  EXPECT_EQ(valueOfWall(), kOccupiedCell);  // 1 of 3
  mapper.add(singleBeam(2.0F), pose);
  EXPECT_EQ(valueOfWall(), kFreeCell);  // 1 of 4
}

TEST(OccupancyMapper, MapNeverGrowsBeyondItsCap) {
  OccupancyMapperParameters parameters;
  parameters.max_cell_count = 1000000;
  OccupancyMapper mapper(parameters);
  mapper.add(randomScan(1), {});
  const OccupancyGrid before = mapper.grid();
  EXPECT_THAT(
      [&] {
        mapper.add(randomScan(2), {10000.0, 0.0, 0.0});
      },
      ThrowsMessage<std::length_error>(HasSubstr("more than max_cell_count 1000000")));
  EXPECT_THROW(mapper.add(randomScan(2), {1e30, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(mapper.add(randomScan(2), {0.0, std::nan(""), 0.0}), std::invalid_argument);
  expectSameGrid(mapper.grid(), before);
  mapper.add(randomScan(2), {0.5, 0.0, 0.0});

  parameters.resolution = 0.001;
  parameters.max_cell_count = OccupancyMapperParameters{}.max_cell_count;
  OccupancyMapper fine(parameters);
  EXPECT_THROW(fine.add(randomScan(1), {}), std::length_error);
}

}  // namespace
}  // namespace ram_slam
