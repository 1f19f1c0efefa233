// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/tracker.hpp"

#include <string>

#include <gmock/gmock.h>

#include "ram_slam/fast_slam/fast_slam.hpp"

#include "kidnapped.hpp"

namespace ram_slam {
namespace {

TEST_F(Kidnapped, IsNeverLostWhileItDrives) {
  look({});
  for (const double way_m : {11.5, -11.5, 5.0}) {
    drive(way_m);
    EXPECT_FALSE(slam_.lost());
    EXPECT_LT(error_m(), 0.05);
  }
}

TEST_F(Kidnapped, KnowsItAtOnceAndFindsBackWithoutTouchingTheMap) {
  mapTheRoom();
  truth_ = {11.0, 1.8, 3.0};
  const std::int64_t carried_ns = odometry_.stamp_ns();
  while (!slam_.lost() && odometry_.stamp_ns() < carried_ns + 2'000'000'000)
    look({kStep_m, 0.0, 0.0});
  ASSERT_TRUE(slam_.lost());
  const std::string map = mapBytes();
  for (double way_m = 0.0; way_m < 8.0; way_m += kStep_m) {
    look({kStep_m, 0.0, 0.0});
    if (!slam_.lost()) break;
    EXPECT_EQ(mapBytes(), map);
  }
  ASSERT_FALSE(slam_.lost());
  EXPECT_LT(error_m(), 0.1);
}

TEST_F(Kidnapped, LeavesAWrongPlaceSoonAndItsMapIsAsBefore) {
  mapTheRoom();
  slam_.forgetPose();
  ASSERT_TRUE(slam_.lost());
  const std::string map = mapBytes();
  // A caller states that the robot is elsewhere; it is not.
  PoseWithCovariance2 wrong;
  wrong.pose = slam_.estimate().pose * Pose2{3.0, 0.0, 0.0};
  wrong.covariance.diagonal() << 0.01, 0.01, 0.001;
  slam_.setPose(wrong);
  ASSERT_FALSE(slam_.lost());
  const std::int64_t stated_ns = odometry_.stamp_ns();
  while (!slam_.lost() && odometry_.stamp_ns() < stated_ns + 2'000'000'000)
    look({kStep_m, 0.0, 0.0});
  ASSERT_TRUE(slam_.lost());
  EXPECT_EQ(mapBytes(), map);
}

TEST_F(Kidnapped, AskedToForgetItFindsItsPlaceAgain) {
  mapTheRoom();
  slam_.forgetPose();
  EXPECT_TRUE(slam_.lost());
  EXPECT_EQ(slam_.reason(), LostReason::kRequested);
  drive(4.0);
  EXPECT_FALSE(slam_.lost());
  EXPECT_LT(error_m(), 0.1);
}

TEST_F(Kidnapped, ADisturbanceEndsWhenEverythingIsAsBeforeHoweverLongItTook) {
  mapTheRoom();
  const Pose2 here = truth_;
  truth_ = {11.0, 1.8, 3.0};  // what is seen is of another place, as with people all around
  for (int i = 0; i < 60; ++i) look({});
  ASSERT_TRUE(slam_.lost());
  truth_ = here;
  for (int i = 0; i < 20; ++i) look({});
  EXPECT_FALSE(slam_.lost());
  EXPECT_LT(error_m(), 0.05);
}

TEST_F(Kidnapped, OdometryThatSlippedALittleIsCorrectedAtOnce) {
  mapTheRoom();
  truth_ = truth_ * Pose2{0.1, 0.05, 0.15};
  for (int i = 0; i < 40; ++i) {
    look({kStep_m, 0.0, 0.0});
    EXPECT_FALSE(slam_.lost());
  }
  EXPECT_LT(error_m(), 0.05);
}

TEST_F(Kidnapped, InAnotherBuildingItStaysLost) {
  mapTheRoom();
  carryToAnotherBuilding();
  for (int i = 0; i < 20; ++i) {
    drive(1.2);
    drive(-1.2);
  }
  EXPECT_TRUE(slam_.lost());
}

TEST_F(Kidnapped, WithoutAMapToDenyItBelievesOdometryAfterALongWay) {
  for (int i = 0; i < 100; ++i) look({});
  carryToAnotherBuilding();
  drive(5.0);
  ASSERT_TRUE(slam_.lost());
  for (double way_m = 5.0; way_m < 38.0; way_m += 2.0) {
    drive(1.0);
    drive(-1.0);
  }
  EXPECT_TRUE(slam_.lost());
  for (int i = 0; i < 3; ++i) {
    drive(1.0);
    drive(-1.0);
  }
  EXPECT_FALSE(slam_.lost());
}

TEST_F(Kidnapped, WhileLostNoTrajectoryIsFollowed) {
  mapTheRoom();
  const Trajectory path = slam_.filter().trajectory();
  slam_.forgetPose();
  const std::string map = mapBytes();
  EXPECT_THROW(slam_.followTrajectory(path), std::runtime_error);
  EXPECT_EQ(mapBytes(), map);
}

TEST_F(Kidnapped, GoesOnFromACheckpointWithItsMapAndItsPath) {
  mapTheRoom();
  const LandmarkMap before = slam_.filter().landmarks();
  const Trajectory path = slam_.filter().trajectory();
  const LandmarkId newest = before.landmarks.back().id;
  restart(toBytes(slam_.checkpoint()), 1.0);
  const LandmarkMap after = slam_.filter().landmarks();
  ASSERT_EQ(after.landmarks.size(), before.landmarks.size());
  for (std::size_t i = 0; i < before.landmarks.size(); ++i) {
    EXPECT_EQ(after.landmarks[i].id, before.landmarks[i].id);
    EXPECT_LT((after.landmarks[i].mean_m - before.landmarks[i].mean_m).norm(), 1e-9);
  }
  drive(4.0);
  EXPECT_FALSE(slam_.lost());
  EXPECT_LT(error_m(), 0.05);
  EXPECT_EQ(slam_.filter().landmarks().landmarks.back().id, newest);  // all were seen again
  EXPECT_EQ(slam_.filter().trajectory().front().stamp_ns, path.front().stamp_ns);
  EXPECT_GT(slam_.filter().trajectory().back().stamp_ns, path.back().stamp_ns);
}

TEST_F(Kidnapped, AfterACheckpointTheMapStillBendsAlongASmoothedTrajectory) {
  mapTheRoom();
  restart(toBytes(slam_.checkpoint()), 0.5);
  drive(2.0);
  const LandmarkMap before = slam_.filter().landmarks();
  // Later than the first reading everything lies 10 % farther along x.
  Trajectory stretched = slam_.filter().trajectory();
  for (StampedPose2& stamped : stretched) stamped.pose.x_m *= 1.1;
  slam_.followTrajectory(stretched);
  const LandmarkMap after = slam_.filter().landmarks();
  ASSERT_EQ(after.landmarks.size(), before.landmarks.size());
  bool some_moved = false;
  for (std::size_t i = 0; i < before.landmarks.size(); ++i) {
    ASSERT_EQ(after.landmarks[i].id, before.landmarks[i].id);
    ASSERT_GT(before.landmarks[i].placed_ns, 0);
    const Pose2 placed_from =
        *poseAt(slam_.filter().trajectory(), before.landmarks[i].placed_ns);  // after stretching
    const double moved_m = after.landmarks[i].mean_m.x() - before.landmarks[i].mean_m.x();
    EXPECT_NEAR(moved_m, placed_from.x_m / 11.0, 0.02);
    some_moved = some_moved || moved_m > 0.3;
  }
  EXPECT_TRUE(some_moved);
}

TEST_F(Kidnapped, WhatIsNewAfterACheckpointGetsUnusedIdentifiers) {
  look({});
  drive(2.0);
  const std::string checkpoint = toBytes(slam_.checkpoint());
  drive(6.0);
  const LandmarkId newest = slam_.filter().landmarks().landmarks.back().id;
  const std::size_t known = checkpointFromBytes(checkpoint).map.landmarks.size();
  ASSERT_GT(slam_.filter().landmarks().landmarks.size(), known);
  restart(checkpoint, 0.05);
  drive(3.0);
  const LandmarkMap map = slam_.filter().landmarks();
  ASSERT_GT(map.landmarks.size(), known);
  for (std::size_t i = known; i < map.landmarks.size(); ++i) EXPECT_GT(map.landmarks[i].id, newest);
  EXPECT_LT(error_m(), 0.05);
}

TEST_F(Kidnapped, ALostRobotIsLostAfterItsCheckpoint) {
  mapTheRoom();
  slam_.forgetPose();
  restart(toBytes(slam_.checkpoint()), 0.0);
  EXPECT_TRUE(slam_.lost());
  drive(4.0);
  EXPECT_FALSE(slam_.lost());
  EXPECT_LT(error_m(), 0.1);
}

TEST_F(Kidnapped, ACheckpointThatTheFilterRefusesChangesNothing) {
  mapTheRoom();
  const std::string map = mapBytes();
  Checkpoint bad = slam_.checkpoint();
  bad.map.landmarks[0].covariance_m2.setZero();
  EXPECT_THROW(slam_.restore(bad), std::invalid_argument);
  bad = slam_.checkpoint();
  bad.map.stamp_ns = 0;
  EXPECT_THROW(slam_.restore(bad), std::invalid_argument);
  EXPECT_EQ(mapBytes(), map);
  EXPECT_FALSE(slam_.lost());
}

TEST_F(Kidnapped, FindsItsPlaceByTheViewsOfALoadedMapAndLeavesTheMapAsItIs) {
  mapTheRoom();
  std::vector<PlacedView> views;
  for (double x_m = 1.0; x_m < 13.0; x_m += 0.5) {
    const Pose2 place{x_m, 1.5, 0.0};
    TestLaser laser;
    laser.beam_count = 720;
    laser.field_of_view_rad = 2.0 * M_PI * 719.0 / 720.0;
    views.push_back({start_.inverse() * place, std::make_shared<const LaserView>(
                                                   scanWalls(walls_, place, 1, laser), Pose2{})});
  }
  const LandmarkMap map = slam_.filter().landmarks();
  slam_ = Tracker(fastSlamFactory(FastSlamParameters{}), RecoveryParameters{});
  odometry_ = {};
  slam_.setMap(map, views);
  slam_.fixMap();
  EXPECT_TRUE(slam_.lost());
  EXPECT_EQ(slam_.certainPose().stamp_ns, 0);
  truth_ = {5.0, 1.4, 0.1};
  look({});
  for (int i = 0; i < 80 && slam_.lost(); ++i) look({kStep_m, 0.0, 0.0});
  ASSERT_FALSE(slam_.lost());
  EXPECT_LT(error_m(), 0.1);
  drive(2.0);
  EXPECT_LT(error_m(), 0.05);
  const LandmarkMap after = slam_.filter().landmarks();
  ASSERT_EQ(after.landmarks.size(), map.landmarks.size());
  for (std::size_t i = 0; i < after.landmarks.size(); ++i) {  // means over equal values: rounding
    EXPECT_NEAR((after.landmarks[i].mean_m - map.landmarks[i].mean_m).norm(), 0.0, 1e-12);
    EXPECT_EQ(after.landmarks[i].existence_log_odds, map.landmarks[i].existence_log_odds);
  }
  EXPECT_THROW(slam_.followTrajectory(slam_.filter().trajectory()), std::runtime_error);
}

}  // namespace
}  // namespace ram_slam
