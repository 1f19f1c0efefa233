// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/key_scans.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ram_slam/geometry/trajectory.hpp"

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

TEST(KeyScans, KeepOneScanPerDistanceOrTurn) {
  // 0.1 m per scan: a key scan at 0, 0.3, 0.6 and 0.9 m, rounding aside.
  std::vector<Pose2> poses;
  for (int i = 0; i <= 10; ++i) poses.push_back({0.1001 * i, 0.0, 0.0});
  EXPECT_THAT(scansAt(pillarRoom(), poses, poses).keys(), SizeIs(4));
  // 0.16 rad per scan on the spot: one in two.
  poses.clear();
  for (int i = 0; i <= 10; ++i) poses.push_back({0.0, 0.0, 0.16 * i});
  EXPECT_THAT(scansAt(pillarRoom(), poses, poses).keys(), SizeIs(6));
}

TEST(KeyScans, ReportWhichScansAreKept) {
  KeyScans scans({}, {}, {}, 0.4);
  EXPECT_TRUE(scans.empty());
  EXPECT_TRUE(scans.add(scanWalls(pillarRoom(), {}, 1), {}, {}));
  EXPECT_FALSE(scans.add(scanWalls(pillarRoom(), {0.1, 0.0, 0.0}, 2), {}, {0.1, 0.0, 0.0}));
  EXPECT_TRUE(scans.add(scanWalls(pillarRoom(), {0.4, 0.0, 0.0}, 3), {}, {0.4, 0.0, 0.0}));
  EXPECT_EQ(scans.newestStampNs(), 3);
  EXPECT_THAT(scans.trajectory(), SizeIs(3));
}

/// A drive that rests half-way for some time, a scan each 0.1 s.
std::vector<Pose2> restingHalfWay(int rest_scans) {
  std::vector<Pose2> poses;
  for (int i = 0; i <= 40; ++i) poses.push_back({0.02 * i, 0.0, 0.0});
  for (int i = 0; i < rest_scans; ++i) poses.push_back({0.8 + 0.002 * (i % 3), 0.0, 0.0});
  for (int i = 1; i <= 40; ++i) poses.push_back({0.8 + 0.02 * i, 0.0, 0.0});
  return poses;
}

TEST(KeyScans, AtRestNothingGrows) {
  const std::vector<Pose2> short_rest = restingHalfWay(30);
  const std::vector<Pose2> long_rest = restingHalfWay(300);
  const KeyScans after_short = scansAt(pillarRoom(), short_rest, short_rest);
  const KeyScans after_long = scansAt(pillarRoom(), long_rest, long_rest);
  EXPECT_EQ(after_long.trajectory().size(), after_short.trajectory().size());
  EXPECT_EQ(after_long.keys().size(), after_short.keys().size());
}

TEST(KeyScans, FewerPosesGiveTheSameTrajectoryWithinAnAlignmentsStep) {
  const std::vector<Pose2> truth = restingHalfWay(300);
  const std::vector<Pose2> odometry = withDrift(truth, 0.1);
  KeyScanParameters every_scan;
  every_scan.pose_per_scan = true;
  const auto all = scansAt(pillarRoom(), truth, odometry, every_scan).trajectory();
  const auto few = scansAt(pillarRoom(), truth, odometry).trajectory();
  ASSERT_THAT(all, SizeIs(truth.size()));
  EXPECT_LT(few.size(), all.size() / 5);
  for (const StampedPose2& pose : all) {
    const auto between = poseAt(few, pose.stamp_ns);
    ASSERT_TRUE(between);
    EXPECT_LT((between->translation() - pose.pose.translation()).norm(), 0.05) << pose.stamp_ns;
    EXPECT_NEAR(between->yaw_rad, pose.pose.yaw_rad, 0.01);
  }
}

TEST(KeyScans, TheEndOfALongRestIsInTheTrajectory) {
  const std::vector<Pose2> truth = restingHalfWay(300);
  const auto few = scansAt(pillarRoom(), truth, truth).trajectory();
  const std::int64_t end_ns = 341 * std::int64_t{100'000'000};
  for (const std::int64_t before_ns : {std::int64_t{0}, std::int64_t{10'000'000'000}})
    EXPECT_NEAR(poseAt(few, end_ns - before_ns)->x_m, 0.8, 0.05);
}

TEST(KeyScans, CountTurningAsPath) {
  KeyScanParameters parameters;
  parameters.path_m_per_rad = 2.0;
  const std::vector<Pose2> poses{{}, {0.0, 0.0, 0.5}, {1.0 * std::cos(0.5), std::sin(0.5), 0.5}};
  const KeyScans scans = scansAt(pillarRoom(), poses, poses, parameters);
  ASSERT_THAT(scans.keys(), SizeIs(3));
  EXPECT_NEAR(scans.keys()[1].path_m, 1.0, 1e-12);
  EXPECT_NEAR(scans.keys()[2].path_m, 2.0, 1e-12);
}

TEST(KeyScans, MeanOfTheNearPointsIsTheCentreOfTheView) {
  // A wall ahead, symmetric to the axis, and one that is too far away to count.
  const Walls walls{{{2.0, -1.0}, {2.0, 1.0}}, {{-20.0, -9.0}, {-20.0, 9.0}}};
  const KeyScans scans = scansAt(walls, {Pose2{}}, {Pose2{}});
  EXPECT_NEAR(scans.keys()[0].view_centre_in_laser_m.x(), 2.0, 1e-4);
  EXPECT_NEAR(scans.keys()[0].view_centre_in_laser_m.y(), 0.0, 0.02);
}

TEST(KeyScans, AlignKeyScansBeyondTheGivenMotion) {
  const std::vector<Pose2> truth = thereAndBack(20);
  const std::vector<Pose2> odometry = withDrift(truth, 0.3);
  const KeyScans scans = scansAt(pillarRoom(), truth, odometry);
  const std::vector<StampedPose2> trajectory = scans.trajectory();
  EXPECT_GT(odometry.back().y_m, 0.25);
  EXPECT_NEAR(trajectory.back().pose.y_m, 0.0, 0.02);
  EXPECT_NEAR(scans.givenMotion()[0].from_from_to.y_m, odometry[3].y_m - odometry[0].y_m, 0.01);
  EXPECT_THAT(scans.alignedMotion(), SizeIs(scans.keys().size() - 1));
  // The alignment adds to what is known of the given motion.
  EXPECT_GT(scans.alignedMotion()[0].information(1, 1), scans.givenMotion()[0].information(1, 1));
}

TEST(KeyScans, DoNotDriftWhereTheRobotHasBeenBefore) {
  // Five times along the same line: odometry drifts on, the key scans stay in the map.
  std::vector<Pose2> truth;
  for (int round = 0; round < 5; ++round) {
    const std::vector<Pose2> once = thereAndBack(15);
    truth.insert(truth.end(), once.begin(), once.end());
  }
  const std::vector<Pose2> odometry = withDrift(truth, 0.5);
  const KeyScans scans = scansAt(pillarRoom(), truth, odometry);
  ASSERT_GT(odometry.back().y_m, 0.45);
  for (const StampedPose2& stamped : scans.trajectory()) EXPECT_NEAR(stamped.pose.y_m, 0.0, 0.02);
  // The motion between two key scans is what was measured, not what the map makes of it.
  const PoseEdge& last = scans.alignedMotion().back();
  const Pose2 moved = relativePose(scans.keys()[last.from], scans.keys()[last.to]);
  EXPECT_NE(moved.y_m, last.from_from_to.y_m);
}

TEST(KeyScans, AlignScansBetweenTwoKeyScans) {
  std::vector<Pose2> truth;
  for (int i = 0; i <= 12; ++i) truth.push_back({0.1 * i, 0.0, 0.0});
  std::vector<Pose2> odometry = truth;
  odometry[4].y_m += 0.05;  // an error of one scan that is no key scan
  const KeyScans scans = scansAt(pillarRoom(), truth, odometry);
  EXPECT_NEAR(scans.trajectory()[4].pose.y_m, 0.0, 0.015);
}

TEST(KeyScans, MoveTheScansBetweenWithTheKeyScans) {
  std::vector<Pose2> truth;
  for (int i = 0; i <= 9; ++i) truth.push_back({0.1 * i, 0.0, 0.0});
  KeyScans scans = scansAt(pillarRoom(), truth, truth);
  const std::vector<StampedPose2> before = scans.trajectory();
  std::vector<Pose2> moved;
  for (const KeyScan& key : scans.keys())
    moved.push_back(Pose2{0.0, 1.0, 0.0} * key.map_from_laser);
  scans.setPoses(moved);
  const std::vector<StampedPose2> after = scans.trajectory();
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(after[i].pose.x_m, before[i].pose.x_m, 1e-9);
    EXPECT_NEAR(after[i].pose.y_m, before[i].pose.y_m + 1.0, 1e-9);
  }
}

TEST(KeyScans, LeaveTheirStateUntouchedWhenTheyRefuseAScan) {
  KeyScans scans({}, {}, {}, 0.4);
  const LaserScan scan = scanWalls(pillarRoom(), {}, 5);
  scans.add(scan, {}, {});
  EXPECT_THAT([&] { scans.add(scan, {}, {}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not later than the last one, 5 ns")));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(scans.add(scan, {}, {nan, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(scans.add(scan, {nan, 0.0, 0.0}, {}), std::invalid_argument);
  EXPECT_THROW(scans.add({}, {}, {}), std::invalid_argument);
  EXPECT_THAT(scans.trajectory(), SizeIs(1));
  EXPECT_THAT(scans.alignedMotion(), IsEmpty());
}

TEST(KeyScans, KeepTheMountOfTheLaser) {
  const Pose2 mount{0.3, -0.1, 0.5};
  KeyScans scans({}, {}, {}, 0.4);
  for (int i = 0; i < 4; ++i) {
    const Pose2 map_from_base{0.4 * i, 0.0, 0.0};
    scans.add(scanWalls(pillarRoom(), map_from_base * mount, i + 1), mount, map_from_base);
  }
  ASSERT_THAT(scans.keys(), SizeIs(4));
  for (int i = 0; i < 4; ++i) {
    const KeyScan& key = scans.keys()[static_cast<std::size_t>(i)];
    EXPECT_NEAR(key.map_from_base().x_m, 0.4 * i, 0.01);
    EXPECT_NEAR(key.map_from_base().y_m, 0.0, 0.01);
    EXPECT_NEAR(key.odom_from_base().x_m, 0.4 * i, 1e-12);
    EXPECT_NEAR(wrapAngle(key.map_from_laser.yaw_rad - 0.5), 0.0, 0.005);
  }
}

TEST(KeyScans, FollowTheGivenMotionWhereNothingIsSeen) {
  const std::vector<Pose2> odometry = withDrift(thereAndBack(10), 0.5);
  const KeyScans scans = scansAt({}, odometry, odometry);
  const std::vector<StampedPose2> trajectory = scans.trajectory();
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    EXPECT_NEAR(trajectory[i].pose.x_m, odometry[i].x_m, 1e-9);
    EXPECT_NEAR(trajectory[i].pose.y_m, odometry[i].y_m, 1e-9);
  }
}

constexpr double kStep_m = 0.1;

/// A drive through one room, then along `count` poses through another that has nothing in common
/// with it, and on through the first one.
KeyScans carriedAway(int count, std::int64_t gap_ns = 1) {
  std::vector<Pose2> poses = thereAndBack(10);
  KeyScans scans = scansAt(pillarRoom(), poses, poses);
  TestLaser laser;
  laser.field_of_view_rad = 2.0 * M_PI * 359.0 / 360.0;
  laser.beam_count = 360;
  for (int i = 1; i <= 20; ++i) {
    const Pose2 pose = poses.back() * Pose2{kStep_m * i, 0.0, 0.0};
    const Walls walls = i <= count ? rectangle(-5.3, -1.1, 2.9, 9.4) : pillarRoom();
    scans.add(scanWalls(walls, pose, 10'000'000'000 + gap_ns + i, laser), {}, pose);
  }
  return scans;
}

std::vector<std::size_t> possibleJumps(const KeyScans& scans) {
  std::vector<std::size_t> jumps;
  for (std::size_t i = 0; i < scans.keys().size(); ++i) {
    if (scans.keys()[i].may_be_jump) jumps.push_back(i);
  }
  return jumps;
}

TEST(KeyScans, SuspectThatTheRobotWasCarriedWhereNoScanMeetsThoseBefore) {
  const KeyScans scans = carriedAway(20);
  ASSERT_EQ(possibleJumps(scans).size(), 1U);
  const std::size_t jump = possibleJumps(scans).front();
  EXPECT_FALSE(scans.keys()[jump].is_jump);
  EXPECT_GE(scans.keys()[jump].stamp_ns, 10'000'000'000);
}

TEST(KeyScans, DoNotSuspectItForOneScanThatMeetsNothing) {
  EXPECT_THAT(possibleJumps(carriedAway(4)), testing::IsEmpty());
}

TEST(KeyScans, SuspectItWhereScansAreMissingForLongAndKeepTheFirstOneAfterwards) {
  const KeyScans scans = carriedAway(0, 20'000'000'000);
  ASSERT_EQ(possibleJumps(scans).size(), 1U);
  EXPECT_EQ(scans.keys()[possibleJumps(scans).front()].stamp_ns, 30'000'000'001);
  EXPECT_THAT(possibleJumps(carriedAway(0)), testing::IsEmpty());
}

TEST(KeyScans, SuspectTheOneThatMeetsThoseBeforeTheLeastWhileTheEstimatorCameToBeLost) {
  KeyScans scans = carriedAway(4);
  scans.addPossibleJump(10'000'000'001 - 3'000'000'000, 10'000'000'000 + 15);
  ASSERT_EQ(possibleJumps(scans).size(), 1U);
  const KeyScan& jump = scans.keys()[possibleJumps(scans).front()];
  EXPECT_GT(jump.stamp_ns, 10'000'000'001);
  EXPECT_LE(jump.stamp_ns, 10'000'000'001 + 4);
}

TEST(KeyScans, WaitForTheKeyScanAfterThatBeforeTheySuspectOne) {
  KeyScans scans = carriedAway(0);
  const Pose2 last = scans.keys().back().odom_from_base();
  const std::int64_t lost_ns = scans.newestStampNs() + 1;
  scans.addPossibleJump(scans.newestStampNs(), lost_ns);
  EXPECT_THAT(possibleJumps(scans), IsEmpty());
  const Pose2 next = last * Pose2{0.5, 0.0, 0.0};
  ASSERT_TRUE(scans.add(scanWalls(pillarRoom(), next, lost_ns + 1), {}, next));
  EXPECT_THAT(possibleJumps(scans), testing::ElementsAre(scans.keys().size() - 1));
}

TEST(KeyScans, ForgetTheMotionOfAJumpAndMoveThePartOfTheDriveSince) {
  KeyScans scans = carriedAway(20);
  const std::vector<KeyScan> before = scans.keys();
  const std::size_t jump = possibleJumps(scans).front();
  const std::size_t last = before.size() - 1;
  EXPECT_GT(scans.alignedMotion()[jump - 1].information(0, 0), 1.0);
  const Pose2 target{7.0, -2.0, 1.0};
  scans.setJump(jump, last, target);
  EXPECT_TRUE(scans.keys()[jump].is_jump);
  EXPECT_LT(scans.alignedMotion()[jump - 1].information(0, 0), 1.0);
  EXPECT_LT(scans.givenMotion()[jump - 1].information(2, 2), 1.0);
  EXPECT_NEAR(scans.keys()[last].map_from_laser.x_m, target.x_m, 1e-9);
  EXPECT_EQ(scans.keys()[jump - 1].map_from_laser.x_m, before[jump - 1].map_from_laser.x_m);
  const Pose2 step = relativePose(scans.keys()[last - 1], scans.keys()[last]);
  EXPECT_NEAR(step.x_m, relativePose(before[last - 1], before[last]).x_m, 1e-9);
}

TEST(KeyScans, PutScansBeforeAJumpWhereTheKeyScanBeforeItIs) {
  KeyScans scans = carriedAway(0, 20'000'000'000);
  const std::size_t jump = possibleJumps(scans).front();
  const std::vector<StampedPose2> before = scans.trajectory();
  scans.setJump(jump, jump, {50.0, 0.0, 0.0});
  const std::vector<StampedPose2> after = scans.trajectory();
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double moved_m = (after[i].pose.translation() - before[i].pose.translation()).norm();
    if (before[i].stamp_ns < scans.keys()[jump].stamp_ns) {
      EXPECT_LT(moved_m, 0.1);
    } else {
      EXPECT_GT(moved_m, 40.0);
    }
  }
}

TEST(KeyScans, RelativePoseIsThatOfTheSecondSeenFromTheFirst) {
  std::vector<KeyScan> keys = blindKeyScans(2, 3.0);
  keys[0].map_from_laser.yaw_rad = M_PI_2;
  const Pose2 relative = relativePose(keys[0], keys[1]);
  EXPECT_NEAR(relative.x_m, 0.0, 1e-12);
  EXPECT_NEAR(relative.y_m, -3.0, 1e-12);
  EXPECT_NEAR(relative.yaw_rad, -M_PI_2, 1e-12);
}

}  // namespace
}  // namespace ram_slam
