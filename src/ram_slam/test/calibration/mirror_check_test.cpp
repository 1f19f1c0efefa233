// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/mirror_check.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

/// What a laser sees in a room of 4 m x 7 m, 1 m from its wall and off its middle, with a heading.
LaserScan inRoom(double yaw_rad, double field_rad) {
  LaserScan scan;
  scan.angle_min_rad = -0.5 * field_rad;
  scan.angle_increment_rad = 0.01;
  scan.range_max_m = 20.0F;
  for (double bearing_rad = scan.angle_min_rad; bearing_rad <= 0.5 * field_rad;
       bearing_rad += scan.angle_increment_rad) {
    const double x = std::cos(yaw_rad + bearing_rad);
    const double y = std::sin(yaw_rad + bearing_rad);
    const double to_side_m = (x > 0.0 ? 5.0 : 2.0) / std::max(1e-9, std::abs(x));
    const double to_end_m = (y > 0.0 ? 3.0 : 1.0) / std::max(1e-9, std::abs(y));
    scan.ranges_m.push_back(static_cast<float>(std::min(to_side_m, to_end_m)));
  }
  return scan;
}

/// After turning to that heading in steps of 0.02 rad.
bool isMirroredAfter(double turned_rad, double laser_turn_per_wheel_turn, double field_rad) {
  MirrorCheck check;
  const int count = static_cast<int>(std::abs(turned_rad) / 0.02);
  for (int i = 0; i <= count; ++i) {
    const double yaw_rad = turned_rad * i / std::max(1, count);
    check.add(inRoom(laser_turn_per_wheel_turn * yaw_rad, field_rad), yaw_rad);
  }
  return check.isMirrored();
}

TEST(MirrorCheck, OfALaserThatTurnsWithTheWheelsNothingIsFound) {
  for (const double turned_rad : {0.7, -0.7, 6.0, -6.0}) {
    EXPECT_FALSE(isMirroredAfter(turned_rad, 1.0, 4.7)) << turned_rad;
    EXPECT_FALSE(isMirroredAfter(turned_rad, 1.0, 2.0)) << turned_rad;
  }
}

TEST(MirrorCheck, ALaserThatTurnsAgainstTheWheelsIsFoundWithinHalfARadian) {
  for (const double turned_rad : {0.6, -0.6, 6.0, -6.0}) {
    EXPECT_TRUE(isMirroredAfter(turned_rad, -1.0, 4.7)) << turned_rad;
    EXPECT_TRUE(isMirroredAfter(turned_rad, -1.0, 6.28)) << turned_rad;
  }
}

TEST(MirrorCheck, WheelsThatSpinOnTheSpotSayNothing) {
  EXPECT_FALSE(isMirroredAfter(6.0, 0.0, 4.7));
}

TEST(MirrorCheck, ARobotThatStandsOrDrivesStraightAheadSaysNothing) {
  MirrorCheck check;
  for (int i = 0; i < 100; ++i) check.add(inRoom(0.001 * i, 4.7), 0.001 * (i % 2));
  EXPECT_FALSE(check.isMirrored());
}

TEST(MirrorCheck, ABlindLaserSaysNothing) {
  MirrorCheck check;
  for (int i = 0; i < 100; ++i) {
    LaserScan scan = inRoom(-0.1 * i, 4.7);
    std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), std::nanf(""));
    check.add(scan, 0.1 * i);
  }
  EXPECT_FALSE(check.isMirrored());
}

}  // namespace
}  // namespace ram_slam
