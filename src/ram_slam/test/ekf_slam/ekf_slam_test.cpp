// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ekf_slam/ekf_slam.hpp"

#include <cstdio>

#include <Eigen/LU>

#include "ekf_slam_fixtures.hpp"

namespace ram_slam {
namespace {

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

TEST(EkfSlam, GoesOnAsACopyOfItself) {
  const SyntheticDrive drive = office(2);
  EkfSlam filter{EkfSlamParameters{}};
  for (std::size_t i = 0; i < 50; ++i) feed(filter, drive.lists[i], drive.odometry);
  const std::unique_ptr<LandmarkFilter> copy = filter.clone();
  for (std::size_t i = 50; i < 100; ++i) {
    feed(filter, drive.lists[i], drive.odometry);
    copy->update(drive.lists[i],
                 motionStep(drive.odometry, copy->stamp_ns(), drive.lists[i].stamp_ns), nullptr);
  }
  EXPECT_EQ(copy->estimate().pose.x_m, filter.estimate().pose.x_m);
  EXPECT_EQ((copy->estimate().covariance - filter.estimate().covariance).norm(), 0.0);
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

}  // namespace
}  // namespace ram_slam
