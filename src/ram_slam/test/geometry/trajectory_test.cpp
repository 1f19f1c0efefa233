// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/trajectory.hpp"

#include <cmath>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>

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

TEST(Trajectory, IsRefusedIfStampsDoNotRiseOrPosesAreNotFiniteOrFarOff) {
  EXPECT_NO_THROW(validate({{1, {}}, {2, {}}}));
  EXPECT_THROW(validate({{1, {}}, {1, {}}}), std::invalid_argument);
  EXPECT_THROW(validate({{1, {0.0, std::nan(""), 0.0}}}), std::invalid_argument);
  EXPECT_NO_THROW(validate({{1, {kFarthest_m, -kFarthest_m, 0.0}}}));
  EXPECT_THROW(validate({{1, {1e9, 0.0, 0.0}}}), std::invalid_argument);
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

TEST(Trajectory, PosesAtAnyStampAreThoseOfASearchFromTheFront) {
  Trajectory trajectory;
  std::int64_t stamp_ns = 1000;
  for (int i = 0; i < 40; ++i) {
    stamp_ns += 7 + (i * i) % 23;
    trajectory.push_back({stamp_ns, {0.1 * i, std::sin(0.3 * i), wrapAngle(0.2 * i)}});
  }
  for (std::int64_t at_ns = 990; at_ns < stamp_ns + 10; ++at_ns) {
    std::optional<Pose2> expected;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      if (trajectory[i].stamp_ns == at_ns) expected = trajectory[i].pose;
      if (i == 0 || trajectory[i - 1].stamp_ns >= at_ns || trajectory[i].stamp_ns <= at_ns)
        continue;
      const double fraction =
          static_cast<double>(at_ns - trajectory[i - 1].stamp_ns) /
          static_cast<double>(trajectory[i].stamp_ns - trajectory[i - 1].stamp_ns);
      expected =
          trajectory[i - 1].pose *
          exponential(fraction * logarithm(trajectory[i - 1].pose.inverse() * trajectory[i].pose));
    }
    const std::optional<Pose2> found = poseAt(trajectory, at_ns);
    ASSERT_EQ(found.has_value(), expected.has_value()) << at_ns;
    if (!found) continue;
    EXPECT_LT(componentDifference(*found, *expected).norm(), 1e-9) << at_ns;
  }
}

TEST(Trajectory, TheRefusalNamesTheStamp) {
  try {
    validate({{17, {}}, {42, {}}, {41, {}}});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("at 41 ns"), std::string::npos) << error.what();
  }
}

TEST(OdometryAt, ATurnThatNoRobotDrivesIsAJumpToo) {
  const std::deque<StampedPose2> readings{{0, {0.0, 0.0, 0.0}}, {100'000'000, {0.0, 0.0, 1.0}}};
  EXPECT_EQ(odometryAt(readings, 49'000'000)->yaw_rad, 0.0);
  EXPECT_EQ(odometryAt(readings, 51'000'000)->yaw_rad, 1.0);
  const std::deque<StampedPose2> slower{{0, {0.0, 0.0, 0.0}}, {250'000'000, {0.0, 0.0, 1.0}}};
  EXPECT_NEAR(odometryAt(slower, 50'000'000)->yaw_rad, 0.2, 1e-12);
}

TEST(Trajectory, WithAtMostSoManyPosesKeepsTheNewestHalfAndThinsOutTheOlder) {
  Trajectory trajectory;
  for (std::int64_t i = 0; i < 1000; ++i) trajectory.push_back({i, {}});
  const Trajectory kept = withAtMost(trajectory, 100);
  ASSERT_LE(kept.size(), 100U);
  EXPECT_GE(kept.size(), 90U);
  validate(kept);
  EXPECT_EQ(kept.front().stamp_ns, 0);
  EXPECT_EQ(kept[1].stamp_ns, 19);
  EXPECT_EQ(kept[kept.size() - 50].stamp_ns, 950);
  EXPECT_EQ(kept.back().stamp_ns, 999);
  EXPECT_EQ(withAtMost(trajectory, 1000).size(), 1000U);
  EXPECT_EQ(withAtMost(trajectory, 2).size(), 2U);
  EXPECT_TRUE(withAtMost({}, 2).empty());
}

}  // namespace
}  // namespace ram_slam
