// SPDX-License-Identifier: BSD-3-Clause
// Worlds that are written and read again.
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "ramscout_sim/world.hpp"

#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

World writtenAndRead(const World& world) {
  const testing::TemporaryFolder folder;
  writeWorldFile(world, folder / "world.yaml");
  return readWorld(folder / "world.yaml");
}

World withMaterials() {
  World world;
  world.materials = standardMaterials();
  return world;
}

TEST(WriteWorldFile, StartAndFrictionAreKept) {
  World world;
  world.start = {1.5, -2.25, 0.5};
  world.floor_friction = 0.35;
  const World copy = writtenAndRead(world);
  EXPECT_EQ(copy.start.x_m, 1.5);
  EXPECT_EQ(copy.start.y_m, -2.25);
  EXPECT_EQ(copy.start.yaw_rad, 0.5);
  EXPECT_EQ(copy.floor_friction, 0.35);
  EXPECT_TRUE(copy.solids.empty());
}

TEST(WriteWorldFile, ABoxKeepsItsPoseAlsoIfItIsPitched) {
  World world;
  Solid box;
  box.size_m = {2.0, 1.0, 0.5};
  box.world_from_solid = Eigen::Translation3d(1.0, 2.0, 3.0) *
                         Eigen::AngleAxisd(-2.5, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
  world.solids = {box};
  const World copy = writtenAndRead(world);
  ASSERT_EQ(copy.solids.size(), 1U);
  EXPECT_TRUE(copy.solids[0].size_m.isApprox(box.size_m, 1e-6));
  EXPECT_TRUE(copy.solids[0].world_from_solid.isApprox(box.world_from_solid, 1e-6));
  EXPECT_FALSE(copy.solids[0].drivable);
}

TEST(WriteWorldFile, ACylinderKeepsItsHeightAboveTheFloor) {
  World world;
  Solid cylinder;
  cylinder.shape = Shape::kCylinder;
  cylinder.size_m = {0.4, 0.4, 2.0};
  cylinder.world_from_solid.translation() = Eigen::Vector3d(3.0, -1.0, 1.75);
  world.solids = {cylinder};
  const World copy = writtenAndRead(world);
  ASSERT_EQ(copy.solids.size(), 1U);
  EXPECT_EQ(copy.solids[0].shape, Shape::kCylinder);
  EXPECT_TRUE(copy.solids[0].size_m.isApprox(cylinder.size_m, 1e-6));
  EXPECT_TRUE(copy.solids[0].world_from_solid.isApprox(cylinder.world_from_solid, 1e-6));
}

TEST(WriteWorldFile, SolidsKeepTheirMaterials) {
  World world = withMaterials();
  Material velvet;
  velvet.name = "velvet";
  velvet.reflectivity = 0.03;
  world.materials.push_back(velvet);
  for (std::size_t i = 0; i < world.materials.size(); ++i) {
    Solid box;
    box.material = i;
    world.solids.push_back(box);
  }
  const World copy = writtenAndRead(world);
  ASSERT_EQ(copy.solids.size(), world.solids.size());
  for (std::size_t i = 0; i < world.materials.size(); ++i) {
    const Material& expected = world.materials[i];
    const Material& found = copy.materials.at(copy.solids[i].material);
    EXPECT_EQ(found.name, expected.name);
    EXPECT_EQ(found.surface, expected.surface);
    EXPECT_EQ(found.reflectivity, expected.reflectivity);
    if (expected.surface == Surface::kGlass) {
      EXPECT_EQ(found.glass_return_angle_rad, expected.glass_return_angle_rad);
    }
  }
}

TEST(WriteWorldFile, PeopleKeepTheirWay) {
  World world = withMaterials();
  Person person;
  person.name = "anna";
  person.waypoints_m = {{1.0, 6.0}, {18.0, 6.0}, {18.0, -2.5}};
  person.speed_mps = 0.9;
  person.loop = true;
  person.start_s = 12.5;
  person.height_m = 1.6;
  person.material = 1;
  world.people = {person};
  const World copy = writtenAndRead(world);
  ASSERT_EQ(copy.people.size(), 1U);
  const Person& found = copy.people[0];
  EXPECT_EQ(found.name, "anna");
  ASSERT_EQ(found.waypoints_m.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(found.waypoints_m[i], person.waypoints_m[i]);
  EXPECT_EQ(found.speed_mps, 0.9);
  EXPECT_TRUE(found.loop);
  EXPECT_EQ(found.start_s, 12.5);
  EXPECT_EQ(found.height_m, 1.6);
  EXPECT_EQ(copy.materials.at(found.material).name, world.materials[1].name);
}

TEST(WriteWorldFile, DoorsKeepHingeAndSchedule) {
  World world = withMaterials();
  Door door;
  door.name = "front";
  door.hinge_m = {5.0, 5.5};
  door.width_m = 0.8;
  door.thickness_m = 0.05;
  door.height_m = 2.1;
  door.closed_yaw_rad = 1.25;
  door.open_angle_rad = -1.4;
  door.turn_speed_radps = 0.7;
  door.openness = 0.25;
  door.schedule = {{10.0, 1.0}, {25.0, 0.0}};
  world.doors = {door};
  const World copy = writtenAndRead(world);
  ASSERT_EQ(copy.doors.size(), 1U);
  const Door& found = copy.doors[0];
  EXPECT_EQ(found.name, "front");
  EXPECT_EQ(found.hinge_m, door.hinge_m);
  EXPECT_EQ(found.width_m, 0.8);
  EXPECT_EQ(found.thickness_m, 0.05);
  EXPECT_EQ(found.height_m, 2.1);
  EXPECT_EQ(found.closed_yaw_rad, 1.25);
  EXPECT_EQ(found.open_angle_rad, -1.4);
  EXPECT_EQ(found.turn_speed_radps, 0.7);
  EXPECT_EQ(found.openness, 0.25);
  ASSERT_EQ(found.schedule.size(), 2U);
  EXPECT_EQ(found.schedule[1].time_s, 25.0);
  EXPECT_EQ(found.schedule[0].openness, 1.0);
}

TEST(WriteWorldFile, SpheresAndMeshesAreRefusedByTheFilesName) {
  const testing::TemporaryFolder folder;
  for (const Shape shape : {Shape::kSphere, Shape::kMesh}) {
    World world;
    world.solids.resize(1);
    world.solids[0].shape = shape;
    try {
      writeWorldFile(world, folder / "round.yaml");
      FAIL() << "accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("round.yaml"), std::string::npos);
    }
  }
}

TEST(WriteWorldFile, AFolderThatDoesNotExistIsAnError) {
  const testing::TemporaryFolder folder;
  EXPECT_THROW(writeWorldFile(World(), folder / "none/world.yaml"), std::runtime_error);
}

}  // namespace
}  // namespace ramscout_sim
