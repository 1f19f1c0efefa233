// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/joint_refinement.hpp"

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

/// Key scans whose poses are off by a few centimetres and milliradians.
struct Disturbed {
  KeyScans scans;
  std::vector<Pose2> truth;
  std::vector<KeyScan> keys;

  explicit Disturbed(const Walls& walls)
      : scans(scansAt(walls, thereAndBack(15), thereAndBack(15))), keys(scans.keys()) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      truth.push_back(keys[i].odom_from_laser);
      keys[i].map_from_laser = truth[i];
      if (i == 0) continue;
      const double sign = i % 2 == 0 ? 1.0 : -1.0;
      keys[i].map_from_laser = truth[i] * Pose2{0.03 * sign, -0.04 * sign, 0.01 * sign};
    }
  }

  std::vector<Pose2> refined(const RefinementParameters& parameters) const {
    return refineJointly(keys, scans.givenMotion(), {}, parameters);
  }
};

TEST(RefineJointly, FindsTheTruePosesFromExactScans) {
  const Disturbed drive(pillarRoom());
  const std::vector<Pose2> poses = drive.refined({});
  ASSERT_EQ(poses.size(), drive.truth.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].x_m, drive.truth[i].x_m, 0.003);
    EXPECT_NEAR(poses[i].y_m, drive.truth[i].y_m, 0.003);
    EXPECT_NEAR(poses[i].yaw_rad, drive.truth[i].yaw_rad, 0.002);
  }
}

TEST(RefineJointly, LeavesThePosesWithoutIterations) {
  const Disturbed drive(pillarRoom());
  RefinementParameters none;
  none.iterations = 0;
  const std::vector<Pose2> poses = drive.refined(none);
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_EQ(poses[i].y_m, drive.keys[i].map_from_laser.y_m);
}

TEST(RefineJointly, FollowsTheMotionWhereNothingIsSeen) {
  const Disturbed drive({});
  const std::vector<Pose2> poses = drive.refined({});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].x_m, drive.truth[i].x_m, 1e-4);
    EXPECT_NEAR(poses[i].y_m, drive.truth[i].y_m, 1e-4);
  }
}

TEST(RefineJointly, KeepsTheFirstPose) {
  const Disturbed drive(pillarRoom());
  EXPECT_EQ(drive.refined({}).front().x_m, drive.keys.front().map_from_laser.x_m);
}

}  // namespace
}  // namespace ram_slam
