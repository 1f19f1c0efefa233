// SPDX-License-Identifier: BSD-3-Clause
// What the chassis runs into, rest, and teleports.
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <ode/ode.h>

#include "physics_testing.hpp"

namespace ramscout_sim {
namespace {

using testing::kStep_s;
using testing::kWheelRadius_m;
using testing::onOpenFloor;
using testing::poseOf;
using testing::run;
using testing::shippedRobot;

TEST(Physics, AWallStopsTheRobotAtThreeMetresPerSecond) {
  World world;
  world.floor_friction = 0.4;  // below what the motors can do
  world.solids.push_back(makeWall({5.0, -5.0}, {5.0, 5.0}, 0.02, 2.5));
  Physics physics(shippedRobot(), world, {});
  constexpr double kHalfLength_m = 0.3;
  constexpr double kFace_m = 4.99;
  constexpr double kSpeed_mps = 3.0;
  double deepest_m = 0.0;
  double fastest_mps = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const double speed_radps = 10.0 * kSpeed_mps * std::min(1.0, i / 1000.0);
    physics.step(kStep_s, {{speed_radps, speed_radps}, {}});
    deepest_m = std::max(deepest_m, poseOf(physics).x_m + kHalfLength_m - kFace_m);
    fastest_mps = std::max(fastest_mps, physics.linearVelocity_mps().x());
  }
  EXPECT_GT(fastest_mps, 2.9);
  EXPECT_GT(deepest_m, 0.0);
  EXPECT_LT(deepest_m, kSpeed_mps * kStep_s);
  EXPECT_TRUE(physics.touchesSolid());
  EXPECT_LT(poseOf(physics).x_m, kFace_m - kHalfLength_m + 1e-3);
  // The wheels keep turning: odometry runs on while the robot stays.
  EXPECT_GT(kWheelRadius_m * physics.wheelAngles_rad()[0], 8.0);
}

int ode_messages = 0;
extern "C" void countOdeMessage(int, const char*, va_list) {
  ++ode_messages;
}

TEST(Physics, RammingWallsAtAnyAngleStaysStable) {
  ode_messages = 0;
  dSetMessageHandler(countOdeMessage);
  Physics physics(shippedRobot(), testing::makeRoom(4.0, 3.0), {2.0, 1.5, 0.3});
  for (int burst = 0; burst < 40; ++burst) {
    const double turn_radps = (burst % 5) - 2.0;
    run(physics, 0.5, {10.0 - turn_radps, 10.0 + turn_radps});
    run(physics, 0.2, {-8.0, -6.0 + turn_radps});
    const Pose2 pose = poseOf(physics);
    ASSERT_GT(std::min(pose.x_m, 4.0 - pose.x_m), 0.2) << burst;
    ASSERT_GT(std::min(pose.y_m, 3.0 - pose.y_m), 0.2) << burst;
    ASSERT_GT(physics.worldFromBase().linear()(2, 2), 0.99) << burst;
  }
  dSetMessageHandler(nullptr);
  EXPECT_EQ(ode_messages, 0);
}

TEST(Physics, ARobotAtRestStaysAtRest) {
  Physics physics = onOpenFloor(shippedRobot());
  run(physics, 2.0, {});
  const Eigen::Isometry3d before = physics.worldFromBase();
  run(physics, 600.0, {});
  EXPECT_LT((physics.worldFromBase().translation() - before.translation()).norm(), 1e-6);
  EXPECT_LT(physics.linearVelocity_mps().norm(), 1e-9);
}

TEST(Physics, SameInputsGiveTheSameBits) {
  const World room = testing::makeRoom(4.0, 3.0);
  Physics a(shippedRobot(), room, room.start);
  Physics b(shippedRobot(), room, room.start);
  dRandSetSeed(7);
  run(a, 5.0, {9.0, 8.0});
  dRandSetSeed(42);
  run(b, 5.0, {9.0, 8.0});
  EXPECT_TRUE(a.touchesSolid());
  EXPECT_EQ(a.worldFromBase().matrix(), b.worldFromBase().matrix());
  EXPECT_EQ(a.wheelAngles_rad()[0], b.wheelAngles_rad()[0]);
  EXPECT_EQ(a.linearVelocity_mps(), b.linearVelocity_mps());
}

TEST(Physics, TeleportsToAFreePose) {
  Physics physics(shippedRobot(), testing::makeRoom(4.0, 3.0), {2.0, 1.5, 0.0});
  run(physics, 0.5, {5.0, 5.0});
  const WheelValues angles = physics.wheelAngles_rad();
  physics.setPose({1.0, 1.0, M_PI_2});
  EXPECT_NEAR(poseOf(physics).x_m, 1.0, 1e-12);
  EXPECT_NEAR(poseOf(physics).yaw_rad, M_PI_2, 1e-12);
  EXPECT_EQ(physics.linearVelocity_mps().norm(), 0.0);
  EXPECT_EQ(physics.wheelAngles_rad()[0], angles[0]);
}

TEST(Physics, ARefusedTeleportChangesNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const World room = testing::makeRoom(4.0, 3.0);
  Physics refused(shippedRobot(), room, {1.0, 1.5, 0.0});
  Physics untouched(shippedRobot(), room, {1.0, 1.5, 0.0});
  run(refused, 0.5, {5.0, 5.0});
  run(untouched, 0.5, {5.0, 5.0});
  for (const Pose2& pose :
       {Pose2{0.0, 1.5, 0.0}, Pose2{kNan, 0.0, 0.0}, Pose2{1.0, 1.0, kNan}, Pose2{1e9, 0.0, 0.0}}) {
    EXPECT_THROW(refused.setPose(pose), std::invalid_argument);
  }
  run(refused, 0.5, {5.0, 5.0});
  run(untouched, 0.5, {5.0, 5.0});
  EXPECT_EQ(refused.worldFromBase().matrix(), untouched.worldFromBase().matrix());
  EXPECT_EQ(refused.wheelAngles_rad()[0], untouched.wheelAngles_rad()[0]);
}

TEST(Physics, RefusesToStartInsideASolidOfAnyShape) {
  for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere}) {
    for (const double size_m : {0.1, 4.0}) {
      World world;
      Solid solid;
      solid.shape = shape;
      solid.size_m = Eigen::Vector3d::Constant(size_m);
      solid.world_from_solid.translation().z() = 0.2;
      world.solids.push_back(solid);
      EXPECT_THROW(Physics(shippedRobot(), world, {}), std::invalid_argument)
          << static_cast<int>(shape) << " of " << size_m << " m";
    }
  }
}

}  // namespace
}  // namespace ramscout_sim
