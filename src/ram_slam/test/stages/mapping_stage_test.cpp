// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/mapping_stage.hpp"

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

}  // namespace
}  // namespace ram_slam
