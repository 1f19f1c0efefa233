// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/trajectory.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

TEST(Trajectory, GivesItsPosesAndWhatLiesBetween) {
  const Trajectory trajectory = {
      {100, {0.0, 0.0, 0.0}}, {200, {1.0, 1.0, M_PI_2}}, {400, {1.0, 3.0, M_PI_2}}};
  EXPECT_EQ(poseAt(trajectory, 200)->yaw_rad, M_PI_2);
  EXPECT_NEAR(poseAt(trajectory, 300)->y_m, 2.0, 1e-12);
  // Half of a quarter circle of radius 1 about (0, 1).
  EXPECT_NEAR(poseAt(trajectory, 150)->x_m, std::sin(M_PI_4), 1e-12);
  EXPECT_NEAR(poseAt(trajectory, 150)->y_m, 1.0 - std::cos(M_PI_4), 1e-12);
}

TEST(Trajectory, HasNoPoseOutsideItsStamps) {
  const Trajectory trajectory = {{100, {}}, {200, {}}};
  EXPECT_FALSE(poseAt(trajectory, 99));
  EXPECT_FALSE(poseAt(trajectory, 201));
  EXPECT_TRUE(poseAt(trajectory, 100));
  EXPECT_FALSE(poseAt({}, 100));
}

TEST(Trajectory, IsRefusedIfStampsDoNotRiseOrPosesAreNotFinite) {
  EXPECT_NO_THROW(validate({{1, {}}, {2, {}}}));
  EXPECT_THROW(validate({{1, {}}, {1, {}}}), std::invalid_argument);
  EXPECT_THROW(validate({{1, {0.0, std::nan(""), 0.0}}}), std::invalid_argument);
}

TEST(OdometryAt, IsBetweenReadingsButNotWithinAJump) {
  const std::deque<StampedPose2> readings{{1'000'000'000, {0.0, 0.0, 0.0}},
                                          {2'000'000'000, {1.0, 0.0, 0.0}},
                                          {2'100'000'000, {5.0, 3.0, 1.0}}};
  EXPECT_NEAR(odometryAt(readings, 1'250'000'000)->x_m, 0.25, 1e-12);
  EXPECT_EQ(odometryAt(readings, 2'000'000'000)->x_m, 1.0);
  EXPECT_EQ(odometryAt(readings, 2'040'000'000)->x_m, 1.0);
  EXPECT_EQ(odometryAt(readings, 2'060'000'000)->x_m, 5.0);
  EXPECT_FALSE(odometryAt(readings, 999'999'999));
  EXPECT_FALSE(odometryAt(readings, 2'100'000'001));
}

}  // namespace
}  // namespace ram_slam
