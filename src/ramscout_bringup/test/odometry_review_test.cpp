// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/odometry_review.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

constexpr std::int64_t kStepNs = 10'000'000;

TEST(OdometryReview, FindsWhereTheMotionStands) {
  std::vector<OdometryReading> readings(3);
  EXPECT_EQ(reviewOdometry(readings), OdometryContent::kNothing);
  readings[1].twist.x_m = 0.3;
  EXPECT_EQ(reviewOdometry(readings), OdometryContent::kTwist);
  readings[2].odom_from_child.yaw_rad = 0.01;
  EXPECT_EQ(reviewOdometry(readings), OdometryContent::kPose);
}

TEST(OdometryReview, TwistOfACircleIntegratesToThatCircle) {
  constexpr int kCount = 315;  // half a turn at 1 rad/s and 0.5 m/s: a circle of 0.5 m
  std::vector<OdometryReading> readings;
  for (int i = 0; i <= kCount; ++i) readings.push_back({i * kStepNs, {}, {0.5, 0.0, 1.0}});
  integrateTwist(readings);
  const double angle_rad = 1e-9 * static_cast<double>(kCount * kStepNs);
  const ram_slam::Pose2& end = readings.back().odom_from_child;
  EXPECT_NEAR(end.x_m, 0.5 * std::sin(angle_rad), 1e-9);
  EXPECT_NEAR(end.y_m, 0.5 * (1.0 - std::cos(angle_rad)), 1e-9);
  EXPECT_NEAR(end.yaw_rad, ram_slam::wrapAngle(angle_rad), 1e-9);
}

TEST(OdometryReview, MotionBelowAnEncodersStepIsNone) {
  std::vector<OdometryReading> readings(2);
  readings[1].odom_from_child.x_m = 1e-7;
  readings[1].twist.yaw_rad = 1e-7;
  EXPECT_EQ(reviewOdometry(readings), OdometryContent::kNothing);
  readings[1].twist.yaw_rad = -1e-3;
  EXPECT_EQ(reviewOdometry(readings), OdometryContent::kTwist);
  EXPECT_EQ(reviewOdometry({}), OdometryContent::kNothing);
}

TEST(OdometryReview, AStepLastsAsLongAsItsStampsAreApart) {
  std::vector<OdometryReading> readings{{0, {}, {1.0, 0.5, 0.0}},
                                        {2'000'000'000, {}, {0.0, 0.0, 1.0}},
                                        {2'500'000'000, {}, {9.0, 9.0, 9.0}}};
  integrateTwist(readings);
  EXPECT_NEAR(readings[1].odom_from_child.x_m, 2.0, 1e-12);
  EXPECT_NEAR(readings[1].odom_from_child.y_m, 1.0, 1e-12);
  EXPECT_NEAR(readings[2].odom_from_child.x_m, 2.0, 1e-12);
  EXPECT_NEAR(readings[2].odom_from_child.yaw_rad, 0.5, 1e-12);
}

}  // namespace
}  // namespace ramscout_bringup
