// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/start_pose.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "shared.hpp"

namespace ramscout_sim {
namespace {

TEST(Start, InsideAWallIsRefusedWithTheNearestFreePose) {
  World room = testing::makeRoom(8.0, 5.0);
  room.start = {8.05, 2.5, 0.0};
  std::string reason;
  try {
    startedPhysics(testing::shippedRobot(), room);
  } catch (const std::invalid_argument& error) {
    reason = error.what();
  }
  EXPECT_THAT(reason, ::testing::HasSubstr("free is ["));
}

TEST(NearestFreePose, IsTheWantedOneWhereTheRobotStandsFree) {
  const auto pose =
      nearestFreePose(testing::shippedRobot(), testing::makeRoom(8.0, 5.0), {4.0, 2.5, 1.0});
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->x_m, 4.0);
  EXPECT_EQ(pose->y_m, 2.5);
  EXPECT_EQ(pose->yaw_rad, 1.0);
}

TEST(NearestFreePose, KeepsTheHeadingAndIsOnARing) {
  const Pose2 wanted{8.05, 2.5, 0.4};
  const auto pose = nearestFreePose(testing::shippedRobot(), testing::makeRoom(8.0, 5.0), wanted);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->yaw_rad, 0.4);
  const double rings = std::hypot(pose->x_m - wanted.x_m, pose->y_m - wanted.y_m) / 0.1;
  EXPECT_NEAR(rings, std::round(rings), 1e-9);
  EXPECT_GT(rings, 0.5);
}

TEST(NearestFreePose, IsNoneBeyondTheOutermostRing) {
  PhysicsParameters parameters;
  parameters.start_rings = 1;
  World block;
  block.solids.resize(1);
  block.solids[0].size_m = {6.0, 6.0, 1.0};
  block.solids[0].world_from_solid.translate(Eigen::Vector3d(0.0, 0.0, 0.5));
  EXPECT_FALSE(nearestFreePose(testing::shippedRobot(), block, {}, parameters));
  parameters.start_rings = 100;
  EXPECT_TRUE(nearestFreePose(testing::shippedRobot(), block, {}, parameters));
}

}  // namespace
}  // namespace ramscout_sim
