// SPDX-License-Identifier: BSD-3-Clause
// Walks the transitions of the table in docs/fast_slam.md; tracker_test.cpp has that by odometry
// alone.
#include <string>

#include <gmock/gmock.h>

#include "ram_slam/tracking/tracker.hpp"

#include "kidnapped.hpp"

namespace ram_slam {
namespace {

class TrackerTransitions : public Kidnapped {
protected:
  const Pose2 elsewhere_{11.0, 1.8, 3.0};

  template <typename State>
  const State* state() const {
    return std::get_if<State>(&slam_.state());
  }

  /// Readings at the robot's place, a step of driving between them, until it is lost.
  void lookUntilLost() {
    for (int i = 0; i < 60 && !slam_.lost(); ++i) look({kStep_m, 0.0, 0.0});
  }

  /// Probation by the map, at the true place.
  void startProbation() {
    PoseWithCovariance2 pose = slam_.estimate();
    pose.covariance.diagonal() << 1e-3, 1e-3, 1e-4;
    slam_.setPose(pose);
  }

  void slipALittle() {
    truth_ = truth_ * Pose2{0.1, 0.05, 0.15};
    for (int i = 0; i < 20; ++i) look({kStep_m, 0.0, 0.0});
  }
};

TEST_F(TrackerTransitions, FromTrackedToProbationByASlipWithTheOldestCopy) {
  mapTheRoom();
  ASSERT_NE(state<Tracked>(), nullptr);
  const std::int64_t oldest_ns = state<Tracked>()->copies.front().stamp_ns;
  const std::int64_t slipped_ns = odometry_.stamp_ns();
  slipALittle();
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_EQ(state<Probation>()->source, PoseSource::kOdometry);
  EXPECT_GE(state<Probation>()->before.stamp_ns, oldest_ns);
  EXPECT_LE(state<Probation>()->before.stamp_ns, slipped_ns - 1'000'000'000);
}

TEST_F(TrackerTransitions, FromProbationToProbationByASlipWithTheSameCopy) {
  mapTheRoom();
  startProbation();
  const std::int64_t before_ns = state<Probation>()->before.stamp_ns;
  for (int i = 0; i < 25; ++i) look({kStep_m, 0.0, 0.0});
  slipALittle();
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_EQ(state<Probation>()->source, PoseSource::kOdometry);
  EXPECT_EQ(state<Probation>()->before.stamp_ns, before_ns);
  EXPECT_GT(state<Probation>()->remaining_m, 14.0);  // it began again
}

TEST_F(TrackerTransitions, FromTrackedToLostWhenCarriedAway) {
  mapTheRoom();
  truth_ = elsewhere_;
  lookUntilLost();
  ASSERT_NE(state<Lost>(), nullptr);
  EXPECT_EQ(state<Lost>()->reason, LostReason::kDiscontinuity);
  EXPECT_TRUE(state<Lost>()->may_be_false_alarm);
}

TEST_F(TrackerTransitions, FromProbationToLostWhenCarriedAwayWithTheMapFromBefore) {
  mapTheRoom();
  const std::string map = mapBytes();
  startProbation();
  for (int i = 0; i < 25; ++i) look({kStep_m, 0.0, 0.0});
  ASSERT_NE(mapBytes(), map);
  truth_ = elsewhere_;
  lookUntilLost();
  EXPECT_EQ(slam_.reason(), LostReason::kDiscontinuity);
  EXPECT_EQ(mapBytes(), map);
}

TEST_F(TrackerTransitions, FromProbationToLostWhenTheMapContradicts) {
  mapTheRoom();
  const std::string map = mapBytes();
  PoseWithCovariance2 wrong = slam_.estimate();
  wrong.pose = wrong.pose * Pose2{3.0, 0.0, 0.0};
  slam_.setPose(wrong);
  lookUntilLost();
  EXPECT_EQ(slam_.reason(), LostReason::kMapContradicts);
  EXPECT_EQ(mapBytes(), map);
}

TEST_F(TrackerTransitions, FromProbationToTrackedAfterItsWayWithOneCopy) {
  mapTheRoom();
  startProbation();
  drive(5.0);
  drive(-5.0);
  drive(4.9);
  EXPECT_NE(state<Probation>(), nullptr);
  drive(0.2);
  ASSERT_NE(state<Tracked>(), nullptr);
  EXPECT_EQ(state<Tracked>()->copies.size(), 1U);
}

TEST_F(TrackerTransitions, FromTrackedOrProbationToTrackedWithoutCopiesByATrajectory) {
  mapTheRoom();
  slam_.followTrajectory(slam_.filter().trajectory());
  ASSERT_NE(state<Tracked>(), nullptr);
  EXPECT_TRUE(state<Tracked>()->copies.empty());
  startProbation();
  slam_.followTrajectory(slam_.filter().trajectory());
  ASSERT_NE(state<Tracked>(), nullptr);
  EXPECT_TRUE(state<Tracked>()->copies.empty());
}

/// A corridor with niches, in which places five metres apart look nearly alike.
class CarriedAlongACorridor : public TrackerTransitions {
protected:
  CarriedAlongACorridor() {
    corners_m_ = {{0.0, 0.0}, {24.0, 0.0}, {24.0, 3.0}};
    for (const double niche_m : {21.5, 17.9, 12.6, 8.8, 5.0, 1.7}) {
      corners_m_.insert(
          corners_m_.end(),
          {{niche_m + 1.0, 3.0}, {niche_m + 1.0, 3.8}, {niche_m, 3.8}, {niche_m, 3.0}});
    }
    corners_m_.emplace_back(0.0, 3.0);
    walls_ = outline(corners_m_);
    look({});
    drive(20.0);
    drive(-16.0);
  }

  void carry(double way_m) {
    truth_ = truth_ * Pose2{way_m, 0.0, 0.0};
    for (int i = 0; i < 20 && state<Tracked>() != nullptr; ++i) look({kStep_m, 0.0, 0.0});
  }
};

TEST_F(CarriedAlongACorridor, FromTrackedToProbationWithTheMapFromBefore) {
  const std::int64_t carried_ns = odometry_.stamp_ns();
  carry(5.3);
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_TRUE(state<Probation>()->relocaliser);
  EXPECT_EQ(state<Probation>()->source, PoseSource::kTracking);
  EXPECT_LE(state<Probation>()->before.stamp_ns, carried_ns);
}

TEST_F(CarriedAlongACorridor, FromProbationToLostAndBackToProbationWhereItIs) {
  carry(5.3);
  for (int i = 0; i < 100 && !slam_.lost(); ++i) look({kStep_m, 0.0, 0.0});
  ASSERT_NE(state<Lost>(), nullptr);
  EXPECT_EQ(state<Lost>()->reason, LostReason::kDiscontinuity);
  EXPECT_FALSE(state<Lost>()->may_be_false_alarm);
  for (int i = 0; i < 60 && slam_.lost(); ++i) look({kStep_m, 0.0, 0.0});
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_EQ(state<Probation>()->source, PoseSource::kMap);
  EXPECT_LT(error_m(), 0.1);
}

TEST_F(CarriedAlongACorridor, ADoubtOutlivesACorrectedTrajectory) {
  carry(5.3);
  slam_.followTrajectory(slam_.filter().trajectory());
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_TRUE(state<Probation>()->relocaliser);
  for (int i = 0; i < 100 && !slam_.lost(); ++i) look({kStep_m, 0.0, 0.0});
  EXPECT_TRUE(slam_.lost());
}

TEST_F(CarriedAlongACorridor, ARobotThatIsWhereItShouldBeIsNotDoubtedForLong) {
  carry(5.3);
  truth_ = truth_ * Pose2{-5.3, 0.0, 0.0};  // it was a scan of another robot
  drive(8.0);
  EXPECT_FALSE(slam_.lost());
  EXPECT_LT(error_m(), 0.1);
}

TEST_F(TrackerTransitions, FromLostToTrackedWhenADisturbanceIsOver) {
  mapTheRoom();
  const Pose2 here = truth_;
  truth_ = elsewhere_;
  for (int i = 0; i < 20; ++i) look({});
  ASSERT_EQ(slam_.reason(), LostReason::kDiscontinuity);
  truth_ = here;
  for (int i = 0; i < 20; ++i) look({});
  ASSERT_NE(state<Tracked>(), nullptr);
  EXPECT_EQ(state<Tracked>()->copies.size(), 1U);
}

TEST_F(TrackerTransitions, FromLostToProbationWhenThePlaceIsFound) {
  mapTheRoom();
  slam_.forgetPose();
  drive(4.0);
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_EQ(state<Probation>()->source, PoseSource::kMap);
}

TEST_F(TrackerTransitions, FromLostToLostWhenOdometryIsInterrupted) {
  mapTheRoom();
  truth_ = elsewhere_;
  lookUntilLost();
  drive(0.3);
  ASSERT_NE(state<Lost>(), nullptr);
  ASSERT_GT(state<Lost>()->relocaliser.distance_m(), 0.25);
  odometry_.variance = 1.0;
  look({});
  ASSERT_NE(state<Lost>(), nullptr);
  EXPECT_EQ(state<Lost>()->reason, LostReason::kDiscontinuity);
  EXPECT_FALSE(state<Lost>()->may_be_false_alarm);
  EXPECT_EQ(state<Lost>()->relocaliser.distance_m(), 0.0);
}

TEST_F(TrackerTransitions, FromEachStateToProbationByAPose) {
  mapTheRoom();
  startProbation();
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_EQ(state<Probation>()->before.stamp_ns, odometry_.stamp_ns());
  drive(1.0);
  startProbation();
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_EQ(state<Probation>()->before.stamp_ns, odometry_.stamp_ns());
  EXPECT_EQ(state<Probation>()->remaining_m, 15.0);
  slam_.forgetPose();
  startProbation();
  ASSERT_NE(state<Probation>(), nullptr);
  EXPECT_EQ(state<Probation>()->source, PoseSource::kMap);
}

TEST_F(TrackerTransitions, BeforeTheFirstReadingToTrackedByAPose) {
  LandmarkMap map;
  LandmarkEstimate landmark;
  landmark.type = "corner";
  landmark.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
  landmark.existence_log_odds = 5.0;
  map.landmarks = {landmark};
  slam_.setMap(map);
  ASSERT_EQ(slam_.reason(), LostReason::kRequested);
  PoseWithCovariance2 pose;
  pose.pose = {1.0, 2.0, 0.5};
  pose.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  slam_.setPose(pose);
  ASSERT_NE(state<Tracked>(), nullptr);
  EXPECT_TRUE(state<Tracked>()->copies.empty());
  EXPECT_NEAR(slam_.estimate().pose.x_m, 1.0, 0.1);
}

TEST_F(TrackerTransitions, FromEachStateToLostOnRequestAndTheMapStays) {
  mapTheRoom();
  slam_.forgetPose();
  ASSERT_NE(state<Lost>(), nullptr);
  EXPECT_EQ(state<Lost>()->reason, LostReason::kRequested);
  EXPECT_FALSE(state<Lost>()->may_be_false_alarm);
  startProbation();
  drive(1.0);
  const std::string map = mapBytes();
  slam_.forgetPose();
  ASSERT_NE(state<Lost>(), nullptr);
  EXPECT_EQ(mapBytes(), map);  // with what was learned on probation
  look({kStep_m, 0.0, 0.0});
  ASSERT_GT(state<Lost>()->relocaliser.distance_m(), 0.0);
  slam_.forgetPose();
  EXPECT_EQ(state<Lost>()->relocaliser.distance_m(), 0.0);
  EXPECT_EQ(state<Lost>()->map_from_base.x_m, slam_.filter().estimate().pose.x_m);
}

TEST_F(TrackerTransitions, ALostRobotRefusesATrajectoryAndStaysLost) {
  mapTheRoom();
  slam_.forgetPose();
  EXPECT_THROW(slam_.followTrajectory(slam_.filter().trajectory()), std::runtime_error);
  EXPECT_NE(state<Lost>(), nullptr);
}

}  // namespace
}  // namespace ram_slam
