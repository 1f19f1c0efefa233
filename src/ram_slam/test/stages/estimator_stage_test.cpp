// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/estimator_stage.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "../dummy_estimator.hpp"

namespace ram_slam {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// 1 m/s along x, known within an interval only; counts the questions.
class Straight : public MotionModel {
public:
  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    ++questions;
    if (from_ns < known_from_ns || to_ns > known_to_ns) throw std::out_of_range("not buffered");
    PoseWithCovariance2 motion;
    motion.pose.x_m = 1e-9 * static_cast<double>(to_ns - from_ns);
    return motion;
  }

  std::int64_t known_from_ns = 0;
  std::int64_t known_to_ns = 1000 * kSecond;
  mutable int questions = 0;
};

class EstimatorStageTest : public testing::Test {
protected:
  EstimatorStageTest() { reset({}); }
  void reset(const EstimatorStageParameters& parameters) {
    stage_ = std::make_unique<EstimatorStage>([] { return std::make_unique<DummyEstimator>(); },
                                              model_, parameters);
  }
  /// \return whether the estimator took it in
  bool read(std::int64_t stamp_ns) {
    const auto step = stage_->motionUntil(stamp_ns);
    if (!step) {
      stage_->bridgeGap(stamp_ns);
      return false;
    }
    FeatureList list;
    list.stamp_ns = stamp_ns;
    pose_ = stage_->poseAt(*step);
    if (!stage_->isDue(*step)) return false;
    const bool used = stage_->update(list, *step, nullptr);
    pose_ = stage_->poseAt(*step);
    return used;
  }

  Straight model_;
  std::unique_ptr<EstimatorStage> stage_;
  Pose2 pose_;
};

TEST_F(EstimatorStageTest, AsksForTheMotionOncePerReading) {
  read(kSecond);
  const int before = model_.questions;
  read(2 * kSecond);
  EXPECT_EQ(model_.questions, before + 1);
  EXPECT_DOUBLE_EQ(pose_.x_m, 1.0);
}

TEST_F(EstimatorStageTest, IsMovedToPosesMeasuredInTheMapOfTheSmoother) {
  // The smoother's frame is another one: its origin is at (0, 5) of the map, turned by 90 degrees.
  const Pose2 smoothed_from_map = Pose2{0.0, 5.0, M_PI_2}.inverse();
  read(kSecond);
  stage_->addMapPose({kSecond, smoothed_from_map});
  stage_->followMapPoses();  // the frames meet here: nothing moves
  read(2 * kSecond);
  EXPECT_NEAR(pose_.x_m, 1.0, 1e-9);
  EXPECT_NEAR(pose_.y_m, 0.0, 1e-9);
  // At 2 s the robot was 0.1 m farther, measured before it drove on for a second.
  stage_->addMapPose({2 * kSecond, smoothed_from_map * Pose2{1.1, 0.2, 0.0}});
  read(3 * kSecond);
  stage_->followMapPoses();
  read(4 * kSecond);
  EXPECT_NEAR(pose_.x_m, 3.1, 1e-9);
  EXPECT_NEAR(pose_.y_m, 0.2, 1e-9);
  EXPECT_EQ(stage_->drops().total(), 0U);
}

TEST_F(EstimatorStageTest, KeepsAMapPoseUntilItsReadingWasDealtWith) {
  read(kSecond);
  stage_->addMapPose({kSecond, {}});
  stage_->addMapPose({2 * kSecond, {1.1, 0.0, 0.0}});
  stage_->followMapPoses();
  read(2 * kSecond);
  EXPECT_NEAR(pose_.x_m, 1.0, 1e-9);
  stage_->followMapPoses();
  EXPECT_NEAR(stage_->estimator().estimate().pose.x_m, 1.1, 1e-9);
}

TEST_F(EstimatorStageTest, AMapPoseFromBeforeAFollowedTrajectoryIsSuperseded) {
  read(kSecond);
  stage_->addMapPose({kSecond, {}});
  read(2 * kSecond);
  stage_->follow({{kSecond, {}}, {2 * kSecond, {1.3, 0.0, 0.0}}});
  stage_->addMapPose({2 * kSecond, {1.0, 0.0, 0.0}});
  stage_->followMapPoses();
  EXPECT_NEAR(stage_->estimator().estimate().pose.x_m, 1.3, 1e-9);
}

TEST_F(EstimatorStageTest, DoesNotBelieveAMapPoseThatIsFarAway) {
  read(kSecond);
  stage_->addMapPose({kSecond, {}});
  read(2 * kSecond);
  stage_->addMapPose({2 * kSecond, {3.0, 0.0, 0.0}});
  stage_->followMapPoses();
  read(3 * kSecond);
  EXPECT_NEAR(pose_.x_m, 2.0, 1e-9);
  EXPECT_EQ(stage_->drops().newest().reason, DropReason::kMapPoseAway);
}

TEST_F(EstimatorStageTest, DoesNotMoveALostRobotToMapPoses) {
  read(kSecond);
  stage_->addMapPose({kSecond, {}});
  read(2 * kSecond);
  stage_->estimator().forgetPose();
  stage_->addMapPose({2 * kSecond, {1.1, 0.0, 0.0}});
  stage_->followMapPoses();
  EXPECT_TRUE(stage_->estimator().isLost());
  EXPECT_NEAR(stage_->estimator().estimate().pose.x_m, 1.0, 1e-9);
}

TEST_F(EstimatorStageTest, LeavesOutReadingsOfARobotThatHardlyMovesButKnowsItsPose) {
  EstimatorStageParameters parameters;
  parameters.minimum_distance_m = 0.5;
  parameters.minimum_angle_rad = 0.5;
  reset(parameters);
  EXPECT_TRUE(read(kSecond));
  EXPECT_FALSE(read(kSecond + 400'000'000));
  EXPECT_DOUBLE_EQ(pose_.x_m, 0.4);
  EXPECT_EQ(stage_->estimator().stamp_ns(), kSecond);
  EXPECT_TRUE(read(kSecond + 600'000'000));
  EXPECT_DOUBLE_EQ(pose_.x_m, 0.6);
}

TEST_F(EstimatorStageTest, BridgesAGapWithTheMotionThatIsKnownOtherwise) {
  read(kSecond);
  model_.known_from_ns = 3 * kSecond;
  EXPECT_FALSE(stage_->motionUntil(3 * kSecond));
  EXPECT_THAT(stage_->missingMotion(), testing::HasSubstr("not buffered"));
  stage_->bridgeGap(3 * kSecond, Pose2{2.5, 0.0, 0.0});
  EXPECT_TRUE(read(4 * kSecond));
  EXPECT_DOUBLE_EQ(pose_.x_m, 3.5);
  ASSERT_EQ(stage_->drops().total(), 1u);
  EXPECT_EQ(stage_->drops().newest().reason, DropReason::kNoMotion);
}

TEST_F(EstimatorStageTest, BeginsAgainWhenTheClockIsSetBack) {
  read(10 * kSecond);
  read(12 * kSecond);
  EXPECT_TRUE(read(kSecond));
  EXPECT_EQ(stage_->resetCount(), 1);
  EXPECT_DOUBLE_EQ(pose_.x_m, 0.0);
}

TEST_F(EstimatorStageTest, CountsReadingsThatComeTooLate) {
  read(kSecond);
  read(2 * kSecond);
  EXPECT_FALSE(read(2 * kSecond - 500'000'000));
  ASSERT_EQ(stage_->drops().total(), 1u);
  EXPECT_EQ(stage_->drops().newest().reason, DropReason::kNotLater);
}

TEST_F(EstimatorStageTest, FollowsACorrectionOnceItsNewestReadingWasDealtWith) {
  read(kSecond);
  stage_->addCorrection({{kSecond, {0.0, 1.0, 0.0}}, {2 * kSecond, {1.0, 1.0, 0.0}}});
  EXPECT_FALSE(stage_->followCorrection());
  read(2 * kSecond);
  const auto corrected = stage_->followCorrection();
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->size(), 2u);
  EXPECT_DOUBLE_EQ(stage_->estimator().estimate().pose.y_m, 1.0);
  EXPECT_FALSE(stage_->followCorrection());
}

TEST_F(EstimatorStageTest, ALostEstimatorFollowsWhenItIsFound) {
  read(kSecond);
  stage_->estimator().forgetPose();
  stage_->addCorrection({{kSecond, {0.0, 1.0, 0.0}}});
  EXPECT_FALSE(stage_->followCorrection());
  stage_->estimator().setPose({});
  EXPECT_TRUE(stage_->followCorrection());
}

TEST_F(EstimatorStageTest, AnUnusableCorrectionIsCounted) {
  read(kSecond);
  stage_->addCorrection({});
  EXPECT_FALSE(stage_->followCorrection());
  ASSERT_EQ(stage_->drops().total(), 1u);
  EXPECT_EQ(stage_->drops().newest().reason, DropReason::kInvalidTrajectory);
}

TEST(EstimatorStageParameters, RefusesNegativeMotions) {
  EstimatorStageParameters parameters;
  parameters.minimum_distance_m = -0.1;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
}

TEST_F(EstimatorStageTest, ALongPauseIsEnoughForAReadingOfARobotAtRest) {
  EstimatorStageParameters parameters;
  parameters.minimum_distance_m = 1000.0;
  parameters.minimum_angle_rad = 3.0;
  parameters.longest_pause_s = 5.0;
  reset(parameters);
  EXPECT_TRUE(read(kSecond));
  EXPECT_FALSE(read(5 * kSecond));
  EXPECT_TRUE(read(6 * kSecond));
  EXPECT_FALSE(read(7 * kSecond));
}

TEST_F(EstimatorStageTest, ANewerCorrectionReplacesTheOneThatWaits) {
  read(kSecond);
  stage_->addCorrection({{kSecond, {0.0, 1.0, 0.0}}, {9 * kSecond, {1.0, 1.0, 0.0}}});
  stage_->addCorrection({{kSecond, {0.0, 5.0, 0.0}}});
  const auto corrected = stage_->followCorrection();
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->size(), 1u);
  EXPECT_DOUBLE_EQ(stage_->estimator().estimate().pose.y_m, 5.0);
}

TEST_F(EstimatorStageTest, AResetForgetsTheMapTheGapAndTheCorrection) {
  read(kSecond);
  model_.known_from_ns = 3 * kSecond;
  EXPECT_FALSE(read(3 * kSecond));
  stage_->addCorrection({{kSecond, {0.0, 1.0, 0.0}}});
  stage_->reset();
  EXPECT_FALSE(stage_->estimator().started());
  EXPECT_FALSE(stage_->followCorrection());
  EXPECT_EQ(stage_->resetCount(), 1);
  EXPECT_TRUE(read(4 * kSecond));
  EXPECT_DOUBLE_EQ(pose_.x_m, 0.0) << "the map begins where the robot is";
}

TEST_F(EstimatorStageTest, TheFirstReadingWaitsUntilTheMotionFromItOnIsKnown) {
  model_.known_from_ns = 2 * kSecond;
  EXPECT_FALSE(read(kSecond));
  EXPECT_FALSE(stage_->estimator().started());
  EXPECT_TRUE(read(2 * kSecond));
  ASSERT_EQ(stage_->drops().total(), 1u);
  EXPECT_EQ(stage_->drops().newest().detail, "not buffered");
}

TEST_F(EstimatorStageTest, AGapWithoutAnyOtherSourceCountsAsStandingStill) {
  read(kSecond);
  model_.known_from_ns = 3 * kSecond;
  EXPECT_FALSE(read(3 * kSecond));
  EXPECT_TRUE(read(4 * kSecond));
  EXPECT_DOUBLE_EQ(pose_.x_m, 1.0);                              // of the last second only
  const double drift_m = 2.0 * GapBridgeParameters{}.drift_mps;  // of two seconds, on each axis
  EXPECT_NEAR(stage_->estimator().estimate().covariance(0, 0),
              std::pow(std::min(drift_m, GapBridgeParameters{}.maximum_drift_m), 2), 1e-9);
}

TEST_F(EstimatorStageTest, ARobotWhoseMotionNobodyKnowsForTenSecondsIsLost) {
  read(kSecond);
  model_.known_from_ns = 100 * kSecond;
  for (std::int64_t s = 2; s <= 11; ++s) read(s * kSecond);
  EXPECT_FALSE(stage_->estimator().isLost());
  stage_->bridgeGap(12 * kSecond, Pose2{1.0, 0.0, 0.0});
  EXPECT_FALSE(stage_->estimator().isLost()) << "its wheels are known from elsewhere";
  read(13 * kSecond);
  EXPECT_TRUE(stage_->estimator().isLost());
}

TEST_F(EstimatorStageTest, ARobotIsNotLostBecauseARecordingPaused) {
  read(kSecond);
  model_.known_from_ns = 100 * kSecond;
  EXPECT_FALSE(read(90 * kSecond));
  EXPECT_FALSE(stage_->estimator().isLost());
}

TEST_F(EstimatorStageTest, AReadingAfterAGapIsTakenInHoweverLittleTheRobotMoved) {
  EstimatorStageParameters parameters;
  parameters.minimum_distance_m = 1000.0;
  parameters.minimum_angle_rad = 3.0;
  parameters.longest_pause_s = 1000.0;
  reset(parameters);
  read(kSecond);
  EXPECT_FALSE(read(2 * kSecond));
  model_.known_from_ns = 3 * kSecond;
  EXPECT_FALSE(stage_->motionUntil(3 * kSecond));
  stage_->bridgeGap(3 * kSecond);
  EXPECT_TRUE(read(4 * kSecond));
  model_.known_from_ns = 0;
  EXPECT_FALSE(read(5 * kSecond)) << "the gap is over";
}

TEST_F(EstimatorStageTest, StatesWhetherTheRobotIsLostAtFirstAndWhenThatChanges) {
  read(kSecond);
  const auto first = stage_->takeTrackingChange();
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->is_lost);
  EXPECT_EQ(first->stamp_ns, kSecond);
  EXPECT_FALSE(stage_->takeTrackingChange());
  stage_->estimator().forgetPose();
  const auto lost = stage_->takeTrackingChange();
  ASSERT_TRUE(lost);
  EXPECT_TRUE(lost->is_lost);
  EXPECT_FALSE(stage_->takeTrackingChange());
  stage_->reset();
  EXPECT_TRUE(stage_->takeTrackingChange());
}

}  // namespace
}  // namespace ram_slam
