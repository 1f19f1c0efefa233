// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/world_corners.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include "ramscout_sim/office.hpp"
#include "ramscout_sim/ray_caster.hpp"

#include "shared.hpp"
#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

using testing::makeRoom;

TEST(WorldCorners, OfARoomAreItsFourInnerOnes) {
  const std::vector<WorldCorner> corners = cornersOf(makeRoom(8.0, 5.0));
  ASSERT_EQ(corners.size(), 4u);
  const WorldCorner& first = corners[0];  // sorted by x, then y
  EXPECT_NEAR(first.position_m.x(), 0.0, 2e-4);
  EXPECT_NEAR(first.position_m.y(), 0.0, 2e-4);
  EXPECT_NEAR(first.opening_rad, M_PI_2, 1e-9);
  EXPECT_NEAR(first.orientation_rad, M_PI_4, 1e-9);
  EXPECT_NEAR(first.left_wall_m, 8.0, 4e-4) << "who faces it from the room has y = 0 left";
  EXPECT_NEAR(first.right_wall_m, 5.0, 4e-4);
}

TEST(WorldCorners, OfAPillarOpenThreeQuartersOfATurn) {
  World world = makeRoom(8.0, 5.0);
  Solid pillar;
  pillar.size_m = {0.4, 1.0, 2.5};
  pillar.world_from_solid =
      Eigen::Translation3d(4.0, 2.5, 1.25) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ());
  world.solids.push_back(pillar);
  world.start = {1.0, 1.0, 0.0};
  int convex = 0;
  for (const WorldCorner& corner : cornersOf(world)) {
    if (corner.opening_rad < M_PI) continue;
    ++convex;
    EXPECT_NEAR(corner.opening_rad, 1.5 * M_PI, 1e-4);
    const Eigen::Vector2d outwards = corner.position_m - Eigen::Vector2d(4.0, 2.5);
    EXPECT_GT(outwards.dot(Eigen::Vector2d(std::cos(corner.orientation_rad),
                                           std::sin(corner.orientation_rad))),
              0.0);
    EXPECT_NEAR(corner.left_wall_m + corner.right_wall_m, 1.4, 1e-3);
  }
  EXPECT_EQ(convex, 4);
}

TEST(WorldCorners, WallsThatMeetAreOneAndCylindersHaveNone) {
  World world = makeRoom(8.0, 5.0);
  world.solids.push_back(makeWall({2.0, -0.1}, {2.0, 3.0}, 0.2, 2.5));  // grows out of y = 0
  Solid bin;
  bin.shape = Shape::kCylinder;
  bin.size_m = {0.4, 0.4, 0.5};
  bin.world_from_solid.translate(Eigen::Vector3d(6.0, 2.0, 0.25));
  world.solids.push_back(bin);
  Solid table;  // above the lidar
  table.size_m = {1.0, 1.0, 0.1};
  table.world_from_solid.translate(Eigen::Vector3d(6.0, 4.0, 0.8));
  world.solids.push_back(table);
  world.start = {5.0, 2.5, 0.0};
  const std::vector<WorldCorner> corners = cornersOf(world);
  EXPECT_EQ(corners.size(), 4u + 4u) << "two where the wall begins, two at its end";
}

/// Rays from 0.2 m in front of a corner to points on both walls end on them.
TEST(WorldCorners, OfAnOfficeLieOnWallsThatRaysHit) {
  const World world = generateOffice({}).world;
  const std::vector<WorldCorner> corners = cornersOf(world);
  EXPECT_GT(corners.size(), 150u);
  const RayCaster caster(world);
  int hit = 0;
  for (const WorldCorner& corner : corners) EXPECT_GT(corner.opening_rad, 0.3) << "no slits";
  for (const WorldCorner& corner : corners) {
    const auto along = [](double angle_rad) {
      return Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    };
    const Eigen::Vector2d eye = corner.position_m + 0.1 * along(corner.orientation_rad);
    std::vector<Ray> rays;
    for (const double side : {0.5, -0.5}) {
      const Eigen::Vector2d target =
          corner.position_m + 0.03 * along(corner.orientation_rad + side * corner.opening_rad);
      const Eigen::Vector2d to_target = target - eye;
      rays.push_back(
          {{static_cast<float>(eye.x()), static_cast<float>(eye.y()), 0.37F},
           Eigen::Vector3d(to_target.x(), to_target.y(), 0.0).normalized().cast<float>()});
      const float distance_m = caster.cast(std::vector<Ray>{rays.back()})[0];
      if (std::abs(distance_m - to_target.norm()) < 2e-3) ++hit;
    }
  }
  EXPECT_GT(hit, static_cast<int>(1.94 * static_cast<double>(corners.size())));
}

TEST(WorldCorners, AreWrittenAsYaml) {
  const testing::TemporaryFolder folder;
  writeCorners(cornersOf(makeRoom(8.0, 5.0)), folder / "corners.yaml");
  const YAML::Node list = YAML::LoadFile(folder / "corners.yaml")["corners"];
  ASSERT_EQ(list.size(), 4u);
  EXPECT_NEAR(list[3]["x"].as<double>(), 8.0, 2e-4);
  EXPECT_NEAR(list[3]["opening_rad"].as<double>(), M_PI_2, 1e-6);
}

TEST(WorldCorners, OpeningsOfARoomAddUpToThoseOfAPolygon) {
  // A room with a step in a wall: six inner corners; the angles of a hexagon add up to 4 pi.
  World world = makeRoom(8.0, 5.0);
  Solid step;
  step.size_m = {2.0, 1.5, 2.5};
  step.world_from_solid = Eigen::Translation3d(7.0, 4.25, 1.25);
  world.solids.push_back(step);
  world.start = {1.0, 1.0, 0.0};
  const std::vector<WorldCorner> corners = cornersOf(world);
  ASSERT_EQ(corners.size(), 6u);
  double sum_rad = 0.0;
  double walls_m = 0.0;
  for (const WorldCorner& corner : corners) {
    sum_rad += corner.opening_rad;
    walls_m += corner.left_wall_m + corner.right_wall_m;
  }
  EXPECT_NEAR(sum_rad, 4.0 * M_PI, 1e-6);
  EXPECT_NEAR(walls_m, 2.0 * 2.0 * (8.0 + 5.0), 1e-2) << "each wall is seen from both of its ends";
}

TEST(WorldCorners, ThatTheRobotCannotReachDoNotCount) {
  World world = makeRoom(8.0, 5.0);
  world.solids.push_back(makeWall({3.0, -0.1}, {3.0, 5.1}, 0.2, 2.5));  // shuts off the left part
  world.start = {6.0, 2.5, 0.0};
  const std::vector<WorldCorner> corners = cornersOf(world);
  EXPECT_EQ(corners.size(), 4u);
  for (const WorldCorner& corner : corners) EXPECT_GT(corner.position_m.x(), 3.0);
}

TEST(WorldCorners, OfSolidsThatTheLidarDoesNotSeeDoNotCount) {
  World world = makeRoom(8.0, 5.0);
  Solid glass;
  glass.size_m = {1.0, 1.0, 2.5};
  glass.world_from_solid = Eigen::Translation3d(2.0, 2.5, 1.25);
  world.start = {6.0, 2.5, 0.0};
  world.solids.push_back(glass);
  EXPECT_EQ(cornersOf(world).size(), 8u);
  world.solids.back().seen = false;
  EXPECT_EQ(cornersOf(world).size(), 4u);
}

TEST(WorldCorners, ParametersOutOfTheirBoundsAreRefused) {
  CornerParameters parameters;
  parameters.circle_sides = 2;
  EXPECT_THROW(cornersOf(makeRoom(8.0, 5.0), parameters), std::invalid_argument);
  parameters = {};
  parameters.resolution_m = 0.0;
  EXPECT_THROW(cornersOf(makeRoom(8.0, 5.0), parameters), std::invalid_argument);
}

TEST(WorldCorners, AFileThatCannotBeWrittenIsNamed) {
  try {
    writeCorners({}, "/nowhere/corners.yaml");
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/corners.yaml: cannot be written");
  }
}

}  // namespace
}  // namespace ramscout_sim
