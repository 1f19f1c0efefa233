// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/actors.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "shared.hpp"
#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

using ::testing::HasSubstr;

Person walker(std::vector<Eigen::Vector2d> waypoints_m) {
  Person person;
  person.name = "anna";
  person.waypoints_m = std::move(waypoints_m);
  person.speed_mps = 1.0;
  return person;
}

Door door() {
  Door d;
  d.name = "front";
  d.hinge_m = {2.0, 0.0};
  d.width_m = 1.0;
  d.open_angle_rad = M_PI_2;
  d.turn_speed_radps = 0.5 * M_PI_2;
  return d;
}

void advance(Actors& actors,
             double from_s,
             double to_s,
             const std::vector<Footprint>& robots = {}) {
  for (double t = from_s; t <= to_s + 1e-9; t += 0.001) actors.advance(t, robots);
}

/// Where the body above the legs is.
Eigen::Vector2d torso(const Actors& actors) {
  return actors.solids()[2].world_from_solid.translation().head<2>();
}

TEST(Actors, APersonWalksToAndFro) {
  World world;
  world.people = {walker({{0.0, 0.0}, {3.0, 0.0}, {3.0, 1.0}})};
  Actors actors(world);
  advance(actors, 0.0, 2.0);
  EXPECT_TRUE(torso(actors).isApprox(Eigen::Vector2d(2.0, 0.0), 0.02));
  advance(actors, 2.0, 3.5);
  EXPECT_TRUE(torso(actors).isApprox(Eigen::Vector2d(3.0, 0.5), 0.02));
  advance(actors, 3.5, 5.0);
  EXPECT_TRUE(torso(actors).isApprox(Eigen::Vector2d(2.98, 0.0), 0.03)) << "back after 4 m";
}

TEST(Actors, APersonWhoLoopsWalksRound) {
  World world;
  world.people = {walker({{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}})};
  world.people[0].loop = true;
  Actors actors(world);
  advance(actors, 0.0, 7.0);
  EXPECT_NEAR((torso(actors) - Eigen::Vector2d(0.0, 1.0)).norm(), 0.0, 0.02);
  advance(actors, 7.0, 9.0);
  EXPECT_NEAR((torso(actors) - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 0.02);
}

TEST(Actors, LegsSwingWhileWalkingAndStandWhileStanding) {
  World world;
  world.people = {walker({{0.0, 0.0}, {3.0, 0.0}})};
  world.people[0].start_s = 1.0;
  Actors actors(world);
  const auto stride = [&actors] {
    const std::vector<Solid> solids = actors.solids();
    return std::abs(solids[0].world_from_solid.translation().x() -
                    solids[1].world_from_solid.translation().x());
  };
  advance(actors, 0.0, 0.9);
  EXPECT_EQ(stride(), 0.0);
  advance(actors, 0.9, 1.0 + 0.35);  // a quarter of the double step
  EXPECT_NEAR(stride(), 0.7, 0.02);
}

TEST(Actors, APersonStopsForARobotAndGoesOnWhenItIsGone) {
  World world;
  world.people = {walker({{0.0, 0.0}, {10.0, 0.0}})};
  Actors actors(world);
  const Footprint robot{{3.0, 0.0}, 0.4};
  advance(actors, 0.0, 5.0, {robot});
  EXPECT_NEAR(torso(actors).x(), 3.0 - 0.9, 0.03);
  advance(actors, 5.0, 7.0);
  EXPECT_GT(torso(actors).x(), 3.5);
  advance(actors, 7.0, 8.0, {{{torso(actors).x() - 0.1, 0.0}, 0.4}});
  EXPECT_GT(torso(actors).x(), 4.5) << "walking away is allowed";
}

TEST(Actors, ADoorTurnsToWhereItIsTold) {
  World world;
  world.doors = {door()};
  Actors actors(world);
  actors.setDoor("front", 1.0);
  advance(actors, 0.0, 1.0);
  EXPECT_NEAR(toPose2(actors.solids()[0].world_from_solid).yaw_rad, M_PI_4, 0.02);
  advance(actors, 1.0, 3.0);
  EXPECT_NEAR(toPose2(actors.solids()[0].world_from_solid).yaw_rad, M_PI_2, 1e-9);
  actors.setDoor("front", 0.5);
  advance(actors, 3.0, 6.0);
  EXPECT_NEAR(toPose2(actors.solids()[0].world_from_solid).yaw_rad, M_PI_4, 1e-9);
}

TEST(Actors, ADoorKeepsItsAppointments) {
  World world;
  world.doors = {door()};
  world.doors[0].schedule = {{6.0, 0.0}, {1.0, 1.0}};
  Actors actors(world);
  const auto yaw = [&actors] { return toPose2(actors.solids()[0].world_from_solid).yaw_rad; };
  advance(actors, 0.0, 0.9);
  EXPECT_EQ(yaw(), 0.0);
  advance(actors, 0.9, 5.0);
  EXPECT_NEAR(yaw(), M_PI_2, 1e-9);
  advance(actors, 5.0, 9.0);
  EXPECT_NEAR(yaw(), 0.0, 1e-9);
}

TEST(Actors, ADoorWaitsForARobotInItsWay) {
  World world;
  world.doors = {door()};
  Actors actors(world);
  actors.setDoor("front", 1.0);
  const Footprint robot{{2.5, 0.5}, 0.3};
  advance(actors, 0.0, 4.0, {robot});
  const Solid stopped = actors.solids()[0];
  EXPECT_LT(toPose2(stopped.world_from_solid).yaw_rad, 0.5);
  advance(actors, 4.0, 8.0);
  EXPECT_NEAR(toPose2(actors.solids()[0].world_from_solid).yaw_rad, M_PI_2, 1e-9);
}

TEST(Actors, AnUnknownDoorIsRefusedWithTheNamesOfTheOthers) {
  World world;
  world.doors = {door()};
  Actors actors(world);
  const auto refusal = [&actors](const std::string& name, double openness) -> std::string {
    try {
      actors.setDoor(name, openness);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("back", 1.0), HasSubstr("there are: front"));
  EXPECT_THAT(refusal("front", 1.5), HasSubstr("0 to 1"));
  EXPECT_THAT(refusal("front", std::nan("")), HasSubstr("0 to 1"));
}

TEST(Actors, ASweepFindsEachWhereItWasWhenTheBeamPassed) {
  World world;
  world.people = {walker({{2.0, -5.0}, {2.0, 5.0}})};
  world.people[0].speed_mps = 2.0;
  Actors actors(world);
  advance(actors, 0.0, 2.4);
  LidarParameters lidar;
  lidar.beams = 361;
  lidar.angle_min_rad = -M_PI;
  lidar.angle_max_rad = M_PI;
  lidar.scan_rate_hz = 10.0;
  lidar.time_increment_s = 0.1 / 361;
  // The sweep of 0.1 s began at 2.3 s and was at bearing 0 in its middle, when y was -0.3 m.
  const Eigen::Isometry3d laser(Eigen::Translation3d(0.0, -0.3, 1.3));
  const Solid body = actors.solidsInSweep(2.3, laser, lidar)[2];
  EXPECT_NEAR(body.world_from_solid.translation().y(), -0.3, 2e-3);
}

TEST(Actors, SameCommandsSameMotion) {
  World world;
  world.people = {walker({{0.0, 0.0}, {3.0, 0.0}})};
  world.doors = {door()};
  Actors a(world);
  Actors b(world);
  for (Actors* actors : {&a, &b}) {
    advance(*actors, 0.0, 1.0);
    actors->setDoor("front", 1.0);
    Person guest = walker({{1.0, 1.0}, {2.0, 2.0}});
    actors->addPerson(guest, 2.0);
    advance(*actors, 1.0, 1.5);
  }
  ASSERT_EQ(a.solids().size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(a.solids()[i].world_from_solid.matrix(), b.solids()[i].world_from_solid.matrix());
  }
  advance(a, 1.5, 2.5);
  EXPECT_EQ(a.solids().size(), 4u) << "the guest has gone";
}

TEST(WorldFileActors, AreReadWrittenAndRefusedByElement) {
  const testing::TemporaryFolder folder;
  const std::string text =
      "materials: [{name: coat, reflectivity: 0.2}]\n"
      "people: [{name: anna, waypoints: [[0, 1], [2, 3]], speed_mps: 0.5, loop: true, material: "
      "coat}]\n"
      "doors: [{name: front, hinge: [1, 2], open_angle_rad: -1.2, schedule: [[3, 1], [5, 0]]}]\n";
  const World world = readWorld(folder.write("w.yaml", text));
  ASSERT_EQ(world.people.size(), 1u);
  EXPECT_EQ(world.materials[world.people[0].material].name, "coat");
  EXPECT_TRUE(world.people[0].loop);
  ASSERT_EQ(world.doors.size(), 1u);
  EXPECT_EQ(world.doors[0].schedule[1].time_s, 5.0);
  writeWorldFile(world, folder / "copy.yaml");
  const World copy = readWorld(folder / "copy.yaml");
  EXPECT_EQ(copy.people[0].waypoints_m, world.people[0].waypoints_m);
  EXPECT_EQ(copy.doors[0].open_angle_rad, -1.2);
  EXPECT_EQ(copy.doors[0].schedule.size(), 2u);

  const auto refusal = [&folder](const std::string& yaml) {
    return testing::refusalOf(readWorld, folder.write("bad.yaml", yaml));
  };
  EXPECT_THAT(refusal("people: [{name: a}]"), HasSubstr("people[0].waypoints"));
  EXPECT_THAT(refusal("people: [{name: a, waypoints: [[0, .nan]]}]"), HasSubstr("people[0]"));
  EXPECT_THAT(refusal("people: [{name: a, waypoints: [[0, 0]], speed_mps: -1}]"),
              HasSubstr("speed_mps"));
  EXPECT_THAT(refusal("doors: [{name: a, hinge: [0, 0]}, {name: a, hinge: [0, 0]}]"),
              HasSubstr("two called 'a'"));
  EXPECT_THAT(refusal("doors: [{hinge: [0, 0]}]"), HasSubstr("doors[0].name"));
  EXPECT_THAT(refusal("doors: [{name: a, hinge: [0, 0], openness: 2}]"), HasSubstr("openness"));
  EXPECT_THAT(refusal("boxes: [{center: [0, 0, 0], size: [1, 1, 1], material: cheese}]"),
              HasSubstr("boxes[0].material: must be one of plaster"));
  EXPECT_THAT(refusal("materials: [{name: x, reflectivity: 2}]"), HasSubstr("reflectivity"));
  EXPECT_THAT(refusal("include: [{file: none.stl}]"), HasSubstr("none.stl"));
}

}  // namespace
}  // namespace ramscout_sim
