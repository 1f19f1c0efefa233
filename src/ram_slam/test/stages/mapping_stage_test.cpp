// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/mapping_stage.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <tuple>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

MountedScan scanAt(std::int64_t stamp_ns) {
  MountedScan scan;
  scan.scan.stamp_ns = stamp_ns;
  scan.scan.angle_min_rad = -1.0;
  scan.scan.angle_increment_rad = 0.01;
  scan.scan.range_max_m = 20.0F;
  scan.scan.ranges_m.assign(200, 3.0F);
  return scan;
}

TEST(MappingStage, DrawsOnlyWhenAsked) {
  MappingStage stage{OccupancyMapperParameters{}};
  stage.add(scanAt(kSecond), {}, {});
  EXPECT_EQ(stage.mapper().grid().width, 0);
  EXPECT_GT(stage.draw().hit, 0);
  EXPECT_GT(stage.mapper().grid().width, 0);
}

TEST(MappingStage, DropsRepeatedAndUnusableScans) {
  MappingStage stage{OccupancyMapperParameters{}};
  stage.add(scanAt(kSecond), {}, {});
  stage.add(scanAt(kSecond), {1.0, 0.0, 0.0}, {});
  MountedScan empty = scanAt(2 * kSecond);
  empty.scan.ranges_m.clear();
  stage.add(empty, {1.0, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 1u);
  const std::vector<Drops> all = stage.drops().all();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].reason, DropReason::kNotLater);
  EXPECT_EQ(all[1].reason, DropReason::kInvalidScan);
}

TEST(MappingStage, CountsScansThatTheMapHasNoRoomFor) {
  MappingStage stage{OccupancyMapperParameters{}};
  stage.add(scanAt(kSecond), {1e9, 0.0, 0.0}, {});
  stage.draw();
  ASSERT_EQ(stage.drops().total(), 1u);
  EXPECT_EQ(stage.drops().newest().reason, DropReason::kMapFull);
  EXPECT_EQ(stage.scanCount(), 0u);
}

TEST(MappingStage, BeginsAgainWhenTheClockIsSetBack) {
  MappingStage stage{OccupancyMapperParameters{}};
  stage.add(scanAt(10 * kSecond), {}, {});
  stage.add(scanAt(11 * kSecond), {1.0, 0.0, 0.0}, {});
  stage.add(scanAt(kSecond), {}, {});
  EXPECT_EQ(stage.resetCount(), 1);
  EXPECT_EQ(stage.scanCount(), 1u);
}

TEST(MappingStage, AfterAResetAnyStampIsNew) {
  MappingStage stage{OccupancyMapperParameters{}};
  stage.add(scanAt(kSecond), {}, {});
  stage.reset();
  stage.add(scanAt(kSecond), {}, {});
  EXPECT_EQ(stage.scanCount(), 1u);
  EXPECT_EQ(stage.drops().total(), 0u);
}

TEST(MappingStage, ACorrectedMapEqualsTheOneDrawnThereAtOnce) {
  const Pose2 wrong{0.4, 0.0, 0.1};
  const Pose2 right{0.5, -0.2, 0.3};
  MappingStage corrected{OccupancyMapperParameters{}};
  corrected.add(scanAt(kSecond), {}, {});
  corrected.add(scanAt(2 * kSecond), wrong, {});
  corrected.draw();
  EXPECT_EQ(corrected.correct({{kSecond, {}}, {2 * kSecond, right}}), 1);
  corrected.draw();
  MappingStage direct{OccupancyMapperParameters{}};
  direct.add(scanAt(kSecond), {}, {});
  direct.add(scanAt(2 * kSecond), right, {});
  direct.draw();
  const OccupancyGrid& a = corrected.mapper().grid();
  const OccupancyGrid& b = direct.mapper().grid();
  const auto knownCells = [](const OccupancyGrid& grid) {
    std::set<std::tuple<int, int, int>> cells;  // by place, since the grids may differ in size
    for (int y = 0; y < grid.height; ++y) {
      for (int x = 0; x < grid.width; ++x) {
        if (grid.at(x, y) == kUnknownCell) continue;
        cells.insert({x + static_cast<int>(std::lround(grid.map_from_grid.x_m / grid.resolution_m)),
                      y + static_cast<int>(std::lround(grid.map_from_grid.y_m / grid.resolution_m)),
                      grid.at(x, y)});
      }
    }
    return cells;
  };
  EXPECT_GT(knownCells(b).size(), 1000u);
  EXPECT_EQ(knownCells(a), knownCells(b));
}

TEST(MappingStage, LeavesOutScansOfARobotThatHardlyMoved) {
  OccupancyMapperParameters parameters;
  MappingStage stage{parameters};
  stage.add(scanAt(kSecond), {}, {});
  stage.add(scanAt(2 * kSecond), {0.5 * parameters.key_distance_m, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 1u);
  stage.add(scanAt(3 * kSecond), {1.5 * parameters.key_distance_m, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 2u);
  stage.add(scanAt(4 * kSecond),
            {1.5 * parameters.key_distance_m, 0.0, 1.5 * parameters.key_angle_rad}, {});
  EXPECT_EQ(stage.scanCount(), 3u);
  EXPECT_EQ(stage.drops().total(), 0u) << "nothing is wrong with them";
}

TEST(MappingStage, APoseThatIsNotFiniteDropsTheScanAndNothingElse) {
  MappingStage stage{OccupancyMapperParameters{}};
  stage.add(scanAt(kSecond), {std::nan(""), 0.0, 0.0}, {});
  stage.add(scanAt(2 * kSecond), {}, {0.0, std::nan(""), 0.0});
  EXPECT_EQ(stage.scanCount(), 0u);
  ASSERT_EQ(stage.drops().total(), 2u);
  EXPECT_EQ(stage.drops().newest().detail, "pose not finite");
  stage.add(scanAt(3 * kSecond), {}, {});
  EXPECT_EQ(stage.scanCount(), 1u);
}

TEST(MappingStage, RefusesATrajectoryWhoseStampsDoNotRise) {
  MappingStage stage{OccupancyMapperParameters{}};
  stage.add(scanAt(kSecond), {}, {});
  EXPECT_THROW(stage.correct({{kSecond, {}}, {kSecond, {}}}), std::invalid_argument);
}

TEST(MappingStage, RefusesParametersOutOfTheirBounds) {
  OccupancyMapperParameters parameters;
  parameters.key_distance_m = -0.1;
  EXPECT_THROW(MappingStage{parameters}, std::invalid_argument);
}

TEST(MappingStage, DrawsNothingThatALostRobotSaw) {
  MappingStage stage{OccupancyMapperParameters{}};
  for (int i = 1; i <= 4; ++i) stage.add(scanAt(i * kSecond), {1.0 * i, 0.0, 0.0}, {});
  EXPECT_EQ(stage.set({true, 4 * kSecond, 2 * kSecond, {}}), 2);
  stage.add(scanAt(5 * kSecond), {5.0, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 2u);
  EXPECT_EQ(stage.drops().newest().reason, DropReason::kLost);
  EXPECT_EQ(stage.set({false, 6 * kSecond, 6 * kSecond, {}}), 0);
  stage.add(scanAt(7 * kSecond), {7.0, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 3u);
}

TEST(MappingStage, ContinuesALoadedMapOnceTheRobotIsFoundInIt) {
  MappingStage first{OccupancyMapperParameters{}};
  first.add(scanAt(100 * kSecond), {}, {});
  first.draw();
  MappingStage stage{OccupancyMapperParameters{}, first.scans()};
  stage.add(scanAt(kSecond), {1.0, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 0u);
  EXPECT_EQ(stage.mapper().grid().cells, first.mapper().grid().cells);
  stage.set({false, 2 * kSecond, 2 * kSecond, {}});
  stage.add(scanAt(3 * kSecond), {1.0, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 1u);
  stage.reset();
  stage.draw();
  EXPECT_EQ(stage.mapper().grid().cells, first.mapper().grid().cells);
  stage.add(scanAt(kSecond), {1.0, 0.0, 0.0}, {});
  EXPECT_EQ(stage.scanCount(), 0u);
}

}  // namespace
}  // namespace ram_slam
