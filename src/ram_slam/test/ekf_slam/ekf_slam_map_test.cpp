// SPDX-License-Identifier: BSD-3-Clause
// What changes pose or map other than by features; src/ekf_slam/ekf_slam_map.cpp.
#include <map>

#include "ekf_slam_fixtures.hpp"

namespace ram_slam {
namespace {

TEST(EkfSlamMap, StatesPositiveSemiDefiniteCovariancesBetweenLandmarks) {
  const LandmarkMap map = runEkf(office(6), {}).landmarks();
  const auto size = 2 * static_cast<Eigen::Index>(map.landmarks.size());
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(size, size);
  std::map<LandmarkId, Eigen::Index> rows;
  for (const LandmarkEstimate& landmark : map.landmarks) {
    const auto row = 2 * static_cast<Eigen::Index>(rows.size());
    rows[landmark.id] = row;
    joint.block<2, 2>(row, row) = landmark.covariance_m2;
  }
  ASSERT_FALSE(map.covariances.empty());
  for (const LandmarkCovariance& between : map.covariances) {
    joint.block<2, 2>(rows[between.first_id], rows[between.second_id]) = between.covariance_m2;
    joint.block<2, 2>(rows[between.second_id], rows[between.first_id]) =
        between.covariance_m2.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(joint, Eigen::EigenvaluesOnly);
  EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0);
}

TEST(EkfSlamMap, LocalisesInAMapThatStaysAsItIs) {
  const SyntheticDrive drive = office(7);
  const LandmarkMap map = runEkf(drive, {}).landmarks();
  EkfSlam filter{EkfSlamParameters{}};
  filter.setMap(map, {});
  filter.fixMap();
  filter.setPose({{}, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
  for (const FeatureList& list : drive.lists) feed(filter, list, drive.odometry);
  EXPECT_LT(errorsOf(filter.trajectory(), drive.truth).position_m, 0.1);
  const LandmarkMap after = filter.landmarks();
  ASSERT_EQ(after.landmarks.size(), map.landmarks.size());
  for (std::size_t i = 0; i < map.landmarks.size(); ++i)
    EXPECT_EQ(after.landmarks[i].mean_m, map.landmarks[i].mean_m);
}

TEST(EkfSlamMap, ContinuesAMap) {
  const SyntheticDrive drive = office(8);
  const EkfSlam first = runEkf(drive, {});
  EkfSlam filter{EkfSlamParameters{}};
  filter.setMap(first.landmarks(), first.trajectory());
  filter.setPose({{}, Eigen::Vector3d(1e-4, 1e-4, 1e-6).asDiagonal()});
  for (const FeatureList& list : drive.lists) feed(filter, list, drive.odometry);
  EXPECT_LE(filter.landmarks().landmarks.size(), first.landmarks().landmarks.size() + 3)
      << "what is known is found, not created again";
}

TEST(EkfSlamMap, FollowsACorrectedTrajectoryWithItsMap) {
  const SyntheticDrive drive = office(9);
  EkfSlam filter = runEkf(drive, {});
  const LandmarkMap before = filter.landmarks();
  // The whole trajectory turned about its start: so is the map.
  Trajectory turned = filter.trajectory();
  const Pose2 turn{0.0, 0.0, 0.1};
  const Pose2 start = turned.front().pose;
  for (StampedPose2& stamped : turned) stamped.pose = start * turn * start.inverse() * stamped.pose;
  const Pose2 map_from_turned = filter.followTrajectory(turned);
  // The first pose stays, so that nothing has moved but the frame of the corrected trajectory.
  EXPECT_NEAR(map_from_turned.yaw_rad, -0.1, 1e-9);
  const LandmarkMap same = filter.landmarks();
  EXPECT_NEAR((same.landmarks[5].mean_m - before.landmarks[5].mean_m).norm(), 0.0, 1e-9);
  // The second half moved: landmarks placed then move along, the others stay.
  Trajectory bent = filter.trajectory();
  const Pose2 shift{0.5, 0.0, 0.0};
  for (std::size_t i = bent.size() / 2; i < bent.size(); ++i) bent[i].pose = shift * bent[i].pose;
  const Pose2 old = filter.estimate().pose;
  filter.followTrajectory(bent);
  EXPECT_NEAR(filter.estimate().pose.x_m, old.x_m + 0.5, 1e-9);
  EXPECT_NEAR((filter.landmarks().landmarks[0].mean_m - before.landmarks[0].mean_m).norm(), 0.0,
              1e-9);
  EXPECT_THROW(filter.followTrajectory({}), std::invalid_argument);
}

TEST(EkfSlamMap, GoesOnFromAPoseThatItIsGiven) {
  const SyntheticDrive drive = office(10);
  EkfSlam filter{EkfSlamParameters{}};
  for (std::size_t i = 0; i < 100; ++i) feed(filter, drive.lists[i], drive.odometry);
  const Pose2 wrong = drive.truth[99] * Pose2{0.3, 0.2, 0.1};
  filter.setPose({wrong, Eigen::Vector3d(0.1, 0.1, 0.03).asDiagonal()});
  EXPECT_EQ(filter.estimate().pose.x_m, wrong.x_m);
  for (std::size_t i = 100; i < 200; ++i) feed(filter, drive.lists[i], drive.odometry);
  EXPECT_LT((filter.estimate().pose.translation() - drive.truth[199].translation()).norm(), 0.15);
}

TEST(EkfSlamMap, MovesThePoseAloneWhenTold) {
  const SyntheticDrive drive = office(11);
  EkfSlam filter{EkfSlamParameters{}};
  for (std::size_t i = 0; i < 60; ++i) feed(filter, drive.lists[i], drive.odometry);
  const Pose2 before = filter.estimate().pose;
  const LandmarkMap map = filter.landmarks();
  const Pose2 move{0.2, -0.1, 0.05};
  filter.movePose(move);
  EXPECT_NEAR(componentDifference(filter.estimate().pose, move * before).norm(), 0.0, 1e-12);
  EXPECT_NEAR(componentDifference(filter.trajectory().back().pose, move * before).norm(), 0.0,
              1e-12);
  EXPECT_EQ(filter.landmarks().landmarks[0].mean_m, map.landmarks[0].mean_m);
}

TEST(EkfSlamMap, IsRefusedWholeIfOneLandmarkIsBroken) {
  const SyntheticDrive drive = office(12);
  EkfSlam filter = runEkf(drive, {});
  const LandmarkMap before = filter.landmarks();
  LandmarkMap broken = before;
  broken.landmarks[2].covariance_m2(0, 0) = -1.0;
  EXPECT_THROW(filter.setMap(broken, {}), std::invalid_argument);
  broken = before;
  std::swap(broken.landmarks[0], broken.landmarks[1]);
  EXPECT_THROW(filter.setMap(broken, {}), std::invalid_argument) << "out of order";
  EXPECT_EQ(filter.landmarks().landmarks.size(), before.landmarks.size());
  EXPECT_EQ(filter.landmarks().landmarks[2].mean_m, before.landmarks[2].mean_m);
}

TEST(EkfSlamMap, IsTakenWithoutCovariancesThatDoNotFitTogether) {
  LandmarkMap map = runEkf(office(13), {}).landmarks();
  ASSERT_FALSE(map.covariances.empty());
  map.covariances[0].covariance_m2 = 1e3 * Eigen::Matrix2d::Identity();
  EkfSlam filter{EkfSlamParameters{}};
  filter.setMap(map, {});
  EXPECT_NEAR(filter.belief().crossCovariance(0, 1).norm(), 0.0, 1e-12);
  EXPECT_NEAR((filter.belief().landmark(0).covariance_m2 - map.landmarks[0].covariance_m2).norm(),
              0.0, 1e-12);
}

}  // namespace
}  // namespace ram_slam
