// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ekf_slam/ekf_slam.hpp"

#include <cstdio>

#include <Eigen/LU>

#include "../fast_slam/fast_slam_fixtures.hpp"

namespace ram_slam {
namespace {

/// As plain() of the particle filter.
EkfSlamParameters plainEkf() {
  EkfSlamParameters parameters;
  parameters.common = plain();
  return parameters;
}

void feed(EkfSlam& filter, const FeatureList& list, const MotionModel& model) {
  filter.update(list, motionStep(model, filter.stamp_ns(), list.stamp_ns));
}

EkfSlam runEkf(const SyntheticDrive& drive, const EkfSlamParameters& parameters) {
  EkfSlam filter(parameters);
  for (const FeatureList& list : drive.lists) feed(filter, list, drive.odometry);
  return filter;
}

double nees(const PoseWithCovariance2& estimate, const Pose2& truth) {
  const Eigen::Vector3d error = componentDifference(estimate.pose, truth);
  return error.dot(estimate.covariance.inverse() * error);
}

TEST(EkfSlam, MapsAnOffice) {
  const SyntheticDrive drive = office(1);
  const EkfSlam filter = runEkf(drive, {});
  EXPECT_LT(errorsOf(filter.trajectory(), drive.truth).position_m, 0.1);
  const LandmarkMap map = filter.landmarks();
  EXPECT_NEAR(static_cast<double>(map.landmarks.size()), 55.0, 10.0);
  for (const LandmarkEstimate& landmark : map.landmarks) {
    double nearest_m = 1e9;
    for (const Eigen::Vector2d& truth_m : drive.landmarks_m)
      nearest_m = std::min(nearest_m, (landmark.mean_m - truth_m).norm());
    EXPECT_LT(nearest_m, 0.3) << landmark.id;
  }
}

/// 95 % of the squared Mahalanobis distances of a pose are in [0.216, 9.348].
TEST(EkfSlamTours, AreThirtyInWhichTheUncertaintyIsHonest) {
  int in_band = 0;
  int count = 0;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const SyntheticDrive drive = office(seed);
    EkfSlam filter(plainEkf());
    for (std::size_t i = 0; i < drive.lists.size(); ++i) {
      feed(filter, drive.lists[i], drive.odometry);
      if (i % 10 != 9) continue;
      const double distance = nees(filter.estimate(), drive.truth[i]);
      in_band += distance >= 0.216 && distance <= 9.348 ? 1 : 0;
      sum += distance;
      ++count;
    }
  }
  const double share = static_cast<double>(in_band) / count;
  std::printf("NEES: mean %.2f (3 expected), in the 95 %% band %.1f %%\n", sum / count,
              100.0 * share);
  EXPECT_GE(share, 0.9);
  EXPECT_LT(sum / count, 4.0);
}

TEST(EkfSlam, GivesTheSameBytesForTheSameInput) {
  const SyntheticDrive drive = office(2);
  const EkfSlam first = runEkf(drive, {});
  const EkfSlam second = runEkf(drive, {});
  EXPECT_EQ(first.estimate().pose.x_m, second.estimate().pose.x_m);
  EXPECT_EQ((first.estimate().covariance - second.estimate().covariance).norm(), 0.0);
}

TEST(EkfSlam, StandingStillChangesNothing) {
  const SyntheticDrive drive = office(3);
  EkfSlam filter = runEkf(drive, {});
  const Eigen::Matrix3d before = filter.belief().poseWithCovariance().covariance;
  FeatureList list = drive.lists.back();
  for (int i = 0; i < 50; ++i) {
    list.stamp_ns += 100'000'000;
    filter.update(list, {filter.stamp_ns(), list.stamp_ns, {}, nullptr});
  }
  EXPECT_EQ((filter.belief().poseWithCovariance().covariance - before).norm(), 0.0);
}

TEST(EkfSlam, RefusesBadInputAndChangesNothing) {
  const SyntheticDrive drive = office(4);
  EkfSlam filter(plainEkf());
  for (std::size_t i = 0; i < 20; ++i) feed(filter, drive.lists[i], drive.odometry);
  const double x_m = filter.estimate().pose.x_m;
  const FeatureList& next = drive.lists[20];
  EXPECT_THROW(filter.update(drive.lists[3], {}), std::invalid_argument) << "it is old";
  FeatureList broken = next;
  broken.features.push_back({});
  broken.features.back().position_m.x() = NAN;
  EXPECT_THROW(feed(filter, broken, drive.odometry), std::invalid_argument);
  MotionStep step{filter.stamp_ns(), next.stamp_ns, {}, nullptr};
  step.motion.pose.x_m = NAN;
  EXPECT_THROW(filter.update(next, step), std::invalid_argument);
  PoseWithCovariance2 pose;
  pose.covariance(0, 0) = -1.0;
  EXPECT_THROW(filter.setPose(pose), std::invalid_argument);
  EXPECT_EQ(filter.estimate().pose.x_m, x_m);
  EXPECT_EQ(filter.stamp_ns(), drive.lists[19].stamp_ns);
  EkfSlamParameters parameters;
  parameters.max_landmarks = 0;
  EXPECT_THROW(EkfSlam{parameters}, std::invalid_argument);
}

TEST(EkfSlam, IgnoresAFeatureBetweenTwoLandmarks) {
  EkfSlamParameters parameters = plainEkf();
  EkfSlam filter(parameters);
  FeatureList two = oneFeature(1, {2.0, 0.25}, 0.01);
  two.features.push_back(two.features[0]);
  two.features[1].position_m.y() = -0.25;
  parameters.common.duplicate_gate = 1.0;
  filter = EkfSlam(parameters);
  filter.update(two, {});
  ASSERT_EQ(filter.belief().size(), 2u);
  filter.update(oneFeature(2, {2.0, 0.0}, 0.01), {1, 2, {}, nullptr});
  EXPECT_EQ(filter.associations()[0].outcome, AssociationOutcome::kIgnored);
  EXPECT_EQ(filter.belief().size(), 2u);
}

TEST(EkfSlam, CreatesNoMoreLandmarksThanItMay) {
  EkfSlamParameters parameters = plainEkf();
  parameters.max_landmarks = 10;
  const EkfSlam filter = runEkf(office(5), parameters);
  EXPECT_EQ(filter.belief().size(), 10u);
  EXPECT_GT(filter.health().back().second, 0.0) << "it is reported";
}

TEST(EkfSlam, StatesPositiveSemiDefiniteCovariancesBetweenLandmarks) {
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

TEST(EkfSlam, LocalisesInAMapThatStaysAsItIs) {
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

TEST(EkfSlam, ContinuesAMap) {
  const SyntheticDrive drive = office(8);
  const EkfSlam first = runEkf(drive, {});
  EkfSlam filter{EkfSlamParameters{}};
  filter.setMap(first.landmarks(), first.trajectory());
  filter.setPose({{}, Eigen::Vector3d(1e-4, 1e-4, 1e-6).asDiagonal()});
  for (const FeatureList& list : drive.lists) feed(filter, list, drive.odometry);
  EXPECT_LE(filter.landmarks().landmarks.size(), first.landmarks().landmarks.size() + 3)
      << "what is known is found, not created again";
}

TEST(EkfSlam, FollowsACorrectedTrajectoryWithItsMap) {
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

TEST(EkfSlam, GoesOnFromAPoseThatItIsGiven) {
  const SyntheticDrive drive = office(10);
  EkfSlam filter{EkfSlamParameters{}};
  for (std::size_t i = 0; i < 100; ++i) feed(filter, drive.lists[i], drive.odometry);
  const Pose2 wrong = drive.truth[99] * Pose2{0.3, 0.2, 0.1};
  filter.setPose({wrong, Eigen::Vector3d(0.1, 0.1, 0.03).asDiagonal()});
  EXPECT_EQ(filter.estimate().pose.x_m, wrong.x_m);
  for (std::size_t i = 100; i < 200; ++i) feed(filter, drive.lists[i], drive.odometry);
  EXPECT_LT((filter.estimate().pose.translation() - drive.truth[199].translation()).norm(), 0.15);
}

}  // namespace
}  // namespace ram_slam
