// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/office.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "ramscout_sim/lidar.hpp"
#include "ramscout_sim/map_image.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/random.hpp"
#include "ramscout_sim/world.hpp"

#include "shared.hpp"
#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

TEST(Office, IsWrittenAndReadBackTheSame) {
  const TemporaryFolder folder;
  const Office office = generateOffice({});
  writeWorldFile(office.world, folder / "office.yaml");
  const World copy = readWorld(folder / "office.yaml");
  ASSERT_EQ(copy.solids.size(), office.world.solids.size());
  // The file lists boxes first.
  std::vector<Solid> expected = office.world.solids;
  std::stable_partition(expected.begin(), expected.end(),
                        [](const Solid& solid) { return solid.shape == Shape::kBox; });
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(copy.solids[i].shape, expected[i].shape);
    EXPECT_TRUE(copy.solids[i].size_m.isApprox(expected[i].size_m, 1e-6));
    EXPECT_TRUE(copy.solids[i].world_from_solid.matrix().isApprox(
        expected[i].world_from_solid.matrix(), 1e-6));
  }
}

TEST(Office, SameSeedSameBuildingAnotherSeedAnother) {
  OfficeParameters other;
  other.seed = 2;
  const World a = generateOffice({}).world;
  const World b = generateOffice({}).world;
  const World c = generateOffice(other).world;
  ASSERT_EQ(a.solids.size(), b.solids.size());
  bool differs = a.solids.size() != c.solids.size();
  for (std::size_t i = 0; i < a.solids.size(); ++i) {
    ASSERT_EQ(a.solids[i].world_from_solid.matrix(), b.solids[i].world_from_solid.matrix());
    if (i < c.solids.size())
      differs |= a.solids[i].world_from_solid.matrix() != c.solids[i].world_from_solid.matrix();
  }
  EXPECT_TRUE(differs);
}

TEST(Office, HasRoomForTheRobotAllAlongTheTour) {
  for (int seed = 1; seed <= 3; ++seed) {
    OfficeParameters parameters;
    parameters.seed = seed;
    parameters.blocks_along_y = seed;
    const Office office = generateOffice(parameters);
    Physics physics(testing::shippedRobot(), office.world, office.world.start);
    const auto& way = office.tour.waypoints_m;
    for (std::size_t i = 1; i < way.size(); ++i) {
      const Eigen::Vector2d along = way[i] - way[i - 1];
      for (double share = 0.0; share <= 1.0; share += 0.02) {
        const Eigen::Vector2d p = way[i - 1] + share * along;
        ASSERT_NO_THROW(physics.setPose({p.x(), p.y(), std::atan2(along.y(), along.x())}));
      }
    }
  }
}

TEST(Office, EveryRoomCanBeEntered) {
  const Office office = generateOffice({});
  const MapImage map = drawMap(office.world, 0.37, 0.05);
  const OfficeParameters p;
  int unreachable = 0;
  int cells = 0;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      const double x = map.world_from_map.x_m + (column + 0.5) * map.resolution_m;
      const double y = map.world_from_map.y_m + (row + 0.5) * map.resolution_m;
      if (x < 0 || y < 0 || x > p.length_m() || y > p.depth_m()) continue;
      ++cells;
      unreachable += map.at(column, row) == Cell::kUnknown ? 1 : 0;
    }
  }
  EXPECT_LT(unreachable, 0.02 * cells);  // insides of furniture and gaps behind it
}

TEST(Office, HasGlassDoorsAndPeopleWithoutChangingTheRest) {
  OfficeParameters plain;
  OfficeParameters lively = plain;
  lively.glass_front_share = 0.5;
  lively.movable_door_share = 1.0;
  lively.people = 6;
  const World before = generateOffice(plain).world;
  const World after = generateOffice(lively).world;
  const auto is_glass = [&after](const Solid& solid) {
    return after.materials[solid.material].surface == Surface::kGlass;
  };
  EXPECT_GT(std::count_if(after.solids.begin(), after.solids.end(), is_glass), 10);
  EXPECT_GT(after.doors.size(), 20U);
  EXPECT_EQ(after.people.size(), 6U);
  EXPECT_EQ(before.people.size() + before.doors.size(), 0U);
  std::size_t same = 0;
  for (const Solid& solid : after.solids) {
    same += std::any_of(before.solids.begin(), before.solids.end(), [&solid](const Solid& other) {
      return other.world_from_solid.matrix() == solid.world_from_solid.matrix();
    });
  }
  EXPECT_EQ(same, after.solids.size()) << "only leaves that stood open are gone";
  EXPECT_NO_THROW(Physics(testing::shippedRobot(), after, after.start));
}

TEST(Office, GoesFromAHundredSquareMetresToASquareKilometre) {
  OfficeParameters small;
  small.blocks_along_x = 1;
  small.blocks_along_y = 0;
  small.block_length_m = 6.0;
  EXPECT_NEAR(small.length_m() * small.depth_m(), 120.0, 1e-9);
  const Office one_corridor = generateOffice(small);
  EXPECT_EQ(one_corridor.tour.waypoints_m.size(), 3U);
  EXPECT_NO_THROW(Physics(testing::shippedRobot(), one_corridor.world, one_corridor.world.start));
  OfficeParameters large;
  large.blocks_along_x = 53;
  large.blocks_along_y = 83;
  EXPECT_GT(large.length_m() * large.depth_m(), 1e6);
  EXPECT_GT(generateOffice(large).world.solids.size(), 100000U);
}

TEST(Office, RefusesBadParametersByName) {
  OfficeParameters parameters;
  parameters.corridor_width_m = 0.5;
  try {
    generateOffice(parameters);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("corridor_width_m"));
  }
}

}  // namespace
}  // namespace ramscout_sim
