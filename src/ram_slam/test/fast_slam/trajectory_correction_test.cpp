// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr std::int64_t kSecondNs = 1'000'000'000;

/// 1 m ahead in each second, exactly.
class OneMetrePerSecond : public MotionModel {
public:
  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    return {{static_cast<double>(to_ns - from_ns) / kSecondNs, 0.0, 0.0}, Eigen::Matrix3d::Zero()};
  }
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t from_ns,
                            std::int64_t to_ns,
                            std::uint64_t /*seed*/) const override {
    std::vector<Pose2> moved;
    for (const Pose2& pose : map_from_base) moved.push_back(pose * motion(from_ns, to_ns).pose);
    return moved;
  }
};

/// A drive along x, on by some seconds each time, one feature 1 m to the left of each pose.
class TrajectoryCorrection : public ::testing::Test {
protected:
  void drive(int seconds) {
    for (int i = 0; i < seconds; ++i) {
      FeatureList list;
      list.stamp_ns = filter_.stamp_ns() + kSecondNs;
      list.features.resize(1);
      list.features[0].type = "pole";
      list.features[0].position_m = {0.0, 1.0};
      list.features[0].covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
      filter_.update(list, OneMetrePerSecond());
    }
  }
  std::string state() const {
    std::string text;
    for (const StampedPose2& pose : filter_.trajectory())
      text += std::to_string(pose.pose.x_m) + " " + std::to_string(pose.pose.y_m) + ",";
    for (const LandmarkEstimate& landmark : filter_.landmarks().landmarks)
      text += std::to_string(landmark.mean_m.x()) + " " + std::to_string(landmark.mean_m.y()) + ",";
    return text;
  }

  FastSlam filter_{FastSlamParameters{}};
};

void expectNear(const Pose2& pose, const Pose2& wanted) {
  EXPECT_NEAR(pose.x_m, wanted.x_m, 1e-12);
  EXPECT_NEAR(pose.y_m, wanted.y_m, 1e-12);
  EXPECT_NEAR(wrapAngle(pose.yaw_rad - wanted.yaw_rad), 0.0, 1e-12);
}

TEST_F(TrajectoryCorrection, LandmarksMoveWithThePoseThatSawThemFirstAndTheRobotWithTheNewest) {
  drive(3);
  const Trajectory corrected{{1 * kSecondNs, {0.0, 0.0, 0.0}},
                             {2 * kSecondNs, {1.1, 0.2, 0.3}},
                             {3 * kSecondNs, {1.9, 0.7, 0.5}}};
  filter_.followTrajectory(corrected);
  const LandmarkMap map = filter_.landmarks();
  ASSERT_THAT(map.landmarks, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d wanted = corrected[i].pose * Eigen::Vector2d(0.0, 1.0);
    EXPECT_LT((map.landmarks[i].mean_m - wanted).norm(), 1e-9);
    expectNear(filter_.trajectory()[i].pose, corrected[i].pose);
  }
  expectNear(filter_.estimate().pose, corrected.back().pose);
  for (const Particle& particle : filter_.particles())
    expectNear(particle.map_from_base, corrected.back().pose);
}

TEST_F(TrajectoryCorrection, MovingThePoseLeavesTheMapAndThePathBefore) {
  drive(3);
  const LandmarkMap map = filter_.landmarks();
  const Trajectory before = filter_.trajectory();
  const Pose2 pose = filter_.estimate().pose;
  const Eigen::Matrix3d covariance = filter_.estimate().covariance;
  filter_.movePose({0.1, -0.2, 0.0});
  EXPECT_NEAR(filter_.estimate().pose.x_m, pose.x_m + 0.1, 1e-12);
  EXPECT_NEAR(filter_.estimate().pose.y_m, pose.y_m - 0.2, 1e-12);
  EXPECT_TRUE(filter_.estimate().covariance.isApprox(covariance));
  const Trajectory after = filter_.trajectory();
  ASSERT_EQ(after.size(), before.size());
  EXPECT_EQ(after[1].pose.x_m, before[1].pose.x_m);
  EXPECT_NEAR(after.back().pose.y_m, before.back().pose.y_m - 0.2, 1e-12);
  ASSERT_THAT(filter_.landmarks().landmarks, SizeIs(map.landmarks.size()));
  EXPECT_EQ(filter_.landmarks().landmarks[0].mean_m, map.landmarks[0].mean_m);
}

TEST_F(TrajectoryCorrection, TheFirstPoseStaysSoThatAnotherFrameChangesNothing) {
  drive(3);
  const Trajectory before = filter_.trajectory();
  const LandmarkMap map_before = filter_.landmarks();
  const Pose2 other_from_map{4.0, -3.0, 2.0};
  Trajectory moved = filter_.trajectory();
  for (StampedPose2& pose : moved) pose.pose = other_from_map * pose.pose;
  expectNear(filter_.followTrajectory(moved), other_from_map.inverse());
  for (std::size_t i = 0; i < before.size(); ++i)
    expectNear(filter_.trajectory()[i].pose, before[i].pose);
  for (std::size_t i = 0; i < map_before.landmarks.size(); ++i) {
    const Eigen::Vector2d change_m =
        filter_.landmarks().landmarks[i].mean_m - map_before.landmarks[i].mean_m;
    EXPECT_LT(change_m.norm(), 1e-12);
  }
}

TEST_F(TrajectoryCorrection, ThePoseIsAsUncertainAsNewGroundMakesItUntilASmootherIsFollowed) {
  const double floor_m = FastSlamParameters{}.pose_noise_floor;
  drive(31);
  const double share = 30.0 / 50.0;
  const Eigen::Matrix3d before = filter_.estimate().covariance;
  EXPECT_NEAR(before(0, 0), (0.25 + share * 3.75) * floor_m * floor_m, 1e-12);
  EXPECT_NEAR(before(2, 2), before(0, 0) / 25.0, 1e-12);
  filter_.followTrajectory(filter_.trajectory());
  drive(1);
  EXPECT_NEAR(filter_.estimate().covariance(1, 1), 0.25 * floor_m * floor_m, 1e-12);
}

TEST_F(TrajectoryCorrection, AStampBeyondTheCorrectionMovesWithItsEnd) {
  drive(3);
  filter_.followTrajectory({{1 * kSecondNs, {}}, {2 * kSecondNs, {1.0, 0.5, 0.0}}});
  expectNear(filter_.estimate().pose, {2.0, 0.5, 0.0});
  EXPECT_NEAR(filter_.landmarks().landmarks[2].mean_m.y(), 1.5, 1e-9);
}

TEST_F(TrajectoryCorrection, ALandmarkThatComesToLieOnAnOlderOneIsDropped) {
  drive(3);
  filter_.followTrajectory(
      {{1 * kSecondNs, {}}, {2 * kSecondNs, {1.0, 0.0, 0.0}}, {3 * kSecondNs, {0.001, 0.0, 0.0}}});
  const LandmarkMap map = filter_.landmarks();
  ASSERT_THAT(map.landmarks, SizeIs(2));
  EXPECT_NEAR(map.landmarks[0].mean_m.x(), 0.0, 1e-9);
  EXPECT_NEAR(map.landmarks[1].mean_m.x(), 1.0, 1e-9);
}

TEST_F(TrajectoryCorrection, WhatCannotBeFollowedIsRefusedAndChangesNothing) {
  EXPECT_THAT(
      [&] {
        filter_.followTrajectory({{kSecondNs, {}}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("no path")));
  drive(3);
  const std::string before = state();
  EXPECT_THROW(filter_.followTrajectory({}), std::invalid_argument);
  EXPECT_THROW(filter_.followTrajectory({{2 * kSecondNs, {}}, {1 * kSecondNs, {}}}),
               std::invalid_argument);
  EXPECT_THROW(
      filter_.followTrajectory({{kSecondNs, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}}}),
      std::invalid_argument);
  EXPECT_THAT(
      [&] {
        filter_.followTrajectory({{9 * kSecondNs, {}}, {10 * kSecondNs, {}}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("no stamp in common")));
  EXPECT_EQ(state(), before);
}

TEST_F(TrajectoryCorrection, InALoadedMapThePathIsMovedAndTheMapStays) {
  LandmarkMap map;
  map.landmarks.resize(1);
  map.landmarks[0].type = "pole";
  map.landmarks[0].mean_m = {20.0, 5.0};
  map.landmarks[0].covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
  map.landmarks[0].existence_log_odds = 5.0;
  filter_.setMap(map);
  drive(3);
  Trajectory moved = filter_.trajectory();
  const Pose2 found_beside{0.2, -0.1, 0.05};
  for (StampedPose2& pose : moved) pose.pose = found_beside * pose.pose;
  expectNear(filter_.followTrajectory(moved), {});
  for (std::size_t i = 0; i < moved.size(); ++i)
    expectNear(filter_.trajectory()[i].pose, moved[i].pose);
  EXPECT_LT((filter_.landmarks().landmarks[0].mean_m - Eigen::Vector2d(20.0, 5.0)).norm(), 1e-12);
  for (StampedPose2& pose : moved) pose.pose = Pose2{10.0, 0.0, 0.0} * pose.pose;
  const std::string before = state();
  EXPECT_THAT([&] { filter_.followTrajectory(moved); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("frame of the map")));
  EXPECT_EQ(state(), before);
}

}  // namespace
}  // namespace ram_slam
