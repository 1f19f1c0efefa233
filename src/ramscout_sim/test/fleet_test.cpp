// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/fleet.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "shared.hpp"

namespace ramscout_sim {
namespace {

FleetMember memberAt(double x_m, double y_m, double yaw_rad) {
  FleetMember member;
  member.robot = testing::shippedRobot();
  member.start = {x_m, y_m, yaw_rad};
  return member;
}

/// Two robots that face each other, 4 m apart, in a room of 10 x 5 m.
Fleet twoRobots() {
  return {{memberAt(3.0, 2.5, 0.0), memberAt(7.0, 2.5, M_PI)}, testing::makeRoom(10.0, 5.0)};
}

std::vector<float> lastScanOfFirst(Fleet& fleet, double duration_s, const Twist2& second) {
  std::vector<float> ranges_m;
  const std::int64_t end_ns = fleet.now_ns() + std::llround(duration_s * 1e9);
  while (fleet.now_ns() < end_ns) {
    fleet[1].command(second);
    const std::vector<Outputs> outputs = fleet.step();
    if (outputs[0].scan) ranges_m = outputs[0].scan->ranges_m;
  }
  return ranges_m;
}

TEST(Fleet, RobotsSeeEachOtherWhereTheyAre) {
  Fleet fleet = twoRobots();
  const float before_m = lastScanOfFirst(fleet, 0.1, {})[540];
  EXPECT_NEAR(before_m, 4.0 - 0.2 - 0.2 - 0.03, 0.05) << "lidar to the other's lidar";
  const float after_m = lastScanOfFirst(fleet, 2.0, {0.5, 0.0, 0.0})[540];
  const double driven_m = 7.0 - toPose2(fleet[1].groundTruth().world_from_base).x_m;
  EXPECT_GT(driven_m, 0.5);
  EXPECT_NEAR(before_m - after_m, driven_m, 0.08);
}

TEST(Fleet, ARobotThatDrivesIntoAnotherIsStopped) {
  Fleet fleet = twoRobots();
  lastScanOfFirst(fleet, 12.0, {0.5, 0.0, 0.0});
  EXPECT_TRUE(fleet[1].inCollision());
  EXPECT_NEAR(toPose2(fleet[1].groundTruth().world_from_base).x_m, 3.0 + 0.6, 0.02);
  EXPECT_NEAR(toPose2(fleet[0].groundTruth().world_from_base).x_m, 3.0, 0.01);
}

TEST(Fleet, PeopleWaitForEveryRobot) {
  World room = testing::makeRoom(10.0, 5.0);
  Person person;
  person.name = "anna";
  person.waypoints_m = {{5.0, 1.0}, {9.0, 1.0}};
  room.people = {person};
  Fleet fleet({memberAt(2.0, 3.5, 0.0), memberAt(7.0, 1.0, M_PI)}, room);
  const std::vector<float> ranges = lastScanOfFirst(fleet, 5.0, {});
  // From (2.2, 3.5) the waiting person's legs are to be seen, as they are from the other robot.
  const double bearing_rad = std::atan2(1.0 - 3.5, 7.0 - 0.875 - 2.2);
  const auto beam = static_cast<std::ptrdiff_t>((bearing_rad + 2.35619449) / (4.71238898 / 1080));
  const float nearest_m = *std::min_element(ranges.begin() + beam - 25, ranges.begin() + beam + 25);
  EXPECT_NEAR(nearest_m, std::hypot(1.0 - 3.5, 7.0 - 0.875 - 2.2), 0.45)
      << "a leg may be a stride ahead";
}

TEST(Fleet, IsTheSameInEveryRun) {
  Fleet a = twoRobots();
  Fleet b = twoRobots();
  EXPECT_EQ(lastScanOfFirst(a, 1.0, {0.5, 0.0, 0.3}), lastScanOfFirst(b, 1.0, {0.5, 0.0, 0.3}));
}

TEST(Fleet, RefusesRobotsThatStartWithinEachOther) {
  EXPECT_THROW(
      Fleet({memberAt(3.0, 2.5, 0.0), memberAt(3.3, 2.5, 0.0)}, testing::makeRoom(10.0, 5.0)),
      std::invalid_argument);
  EXPECT_THROW(Fleet({}, World()), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_sim
