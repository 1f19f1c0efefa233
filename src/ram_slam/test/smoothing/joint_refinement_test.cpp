// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/joint_refinement.hpp"

#include <cmath>

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

TEST(RefineJointly, CountsNoPairsOfScansThatHardlyMeet) {
  const Disturbed drive(pillarRoom());
  RefinementParameters strict;
  strict.min_inlier_ratio = 1.0;  // hardly any pair reaches this while the scans are off
  strict.iterations = 1;
  const std::vector<Pose2> poses = drive.refined(strict);
  // What is left is the given motion, which is exact here.
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_NEAR(poses[i].y_m, drive.truth[i].y_m, 0.01);
}

TEST(RefineJointly, PairsOtherPassagesThatSeeTheSamePlace) {
  // The way back is 3 cm beside the way there; without pairs of chains only passages correct it.
  const std::vector<Pose2> truth = thereAndBack(30);
  std::vector<KeyScan> keys = scansAt(pillarRoom(), truth, truth).keys();
  std::vector<Pose2> expected;
  for (KeyScan& key : keys) {
    expected.push_back(key.map_from_laser);
    if (key.path_m > 3.0) key.map_from_laser.y_m += 0.03;
  }
  RefinementParameters parameters;
  const auto error = [&](const std::vector<Pose2>& poses) {
    return std::abs(poses.back().y_m - expected.back().y_m);
  };
  EXPECT_LT(error(refineJointly(keys, {}, {}, parameters)), 0.005);
}

TEST(RefineJointly, GivesTheSameBitsTwice) {
  const Disturbed drive(pillarRoom());
  const std::vector<Pose2> first = drive.refined({});
  const std::vector<Pose2> second = drive.refined({});
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].x_m, second[i].x_m);
    EXPECT_EQ(first[i].yaw_rad, second[i].yaw_rad);
  }
}

}  // namespace
}  // namespace ram_slam
