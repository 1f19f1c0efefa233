// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/landmark.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gmock/gmock.h>

namespace ram_slam {
namespace {

const Pose2 kPose{1.0, -2.0, 0.7};

Landmark landmark() {
  Landmark result;
  result.mean_m = {3.0, 1.0};
  result.covariance_m2 << 0.04, 0.01, 0.01, 0.02;
  return result;
}

PointMeasurement measured() {
  PointMeasurement result;
  result.position_m = {3.4, 0.9};
  result.covariance_m2 << 0.003, 0.001, 0.001, 0.002;
  return result;
}

TEST(Innovation, HasTheLikelihoodOfANormalDistribution) {
  Innovation standard;
  EXPECT_NEAR(standard.logLikelihood(), -std::log(2.0 * M_PI), 1e-12);
  standard.residual_m = {0.3, 0.4};
  standard.covariance_m2 = 0.25 * Eigen::Matrix2d::Identity();
  EXPECT_NEAR(standard.squaredMahalanobis(), 1.0, 1e-12);
  EXPECT_NEAR(standard.logLikelihood(), -0.5 - std::log(2.0 * M_PI * 0.25), 1e-12);
}

TEST(Innovation, IsZeroForTheLandmarkThatTheMeasurementMakes) {
  const Landmark created = createLandmark(kPose, measured());
  EXPECT_LT(innovation(kPose, created, measured()).residual_m.norm(), 1e-12);
}

TEST(Innovation, HasTheDerivativesOfTheExpectedPosition) {
  constexpr double kStep = 1e-6;
  const auto expectedAt = [](const Pose2& pose, const Landmark& at) -> Eigen::Vector2d {
    return measured().position_m - innovation(pose, at, measured()).residual_m;
  };
  const Innovation found = innovation(kPose, landmark(), measured());
  const Eigen::Vector2d here_m = expectedAt(kPose, landmark());
  const Pose2 moved[] = {{kPose.x_m + kStep, kPose.y_m, kPose.yaw_rad},
                         {kPose.x_m, kPose.y_m + kStep, kPose.yaw_rad},
                         {kPose.x_m, kPose.y_m, kPose.yaw_rad + kStep}};
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d slope = (expectedAt(moved[i], landmark()) - here_m) / kStep;
    EXPECT_LT((slope - found.by_pose.col(i)).norm(), 1e-5) << i;
  }
  for (int i = 0; i < 2; ++i) {
    Landmark other = landmark();
    other.mean_m[i] += kStep;
    const Eigen::Vector2d slope = (expectedAt(kPose, other) - here_m) / kStep;
    EXPECT_LT((slope - found.by_landmark.col(i)).norm(), 1e-5) << i;
  }
}

TEST(Innovation, OfAnUncertainPoseAddsItsCovarianceSeenFromTheBase) {
  PoseWithCovariance2 pose{kPose, Eigen::Matrix3d::Zero()};
  pose.covariance.diagonal() << 0.01, 0.02, 0.001;
  const Innovation known = innovation(kPose, landmark(), measured());
  const Innovation uncertain = innovation(pose, landmark(), measured());
  const Eigen::Matrix2d wanted =
      known.covariance_m2 + known.by_pose * pose.covariance * known.by_pose.transpose();
  EXPECT_TRUE(uncertain.covariance_m2.isApprox(wanted, 1e-12));
}

TEST(Updated, IsTheProductOfBothDistributions) {
  // Information adds up: C^-1 = Sigma^-1 + R^-1 with the measurement's noise turned into the map.
  const Landmark from_measurement = createLandmark(kPose, measured());
  const Landmark result =
      updated(landmark(), innovation(kPose, landmark(), measured()), measured());
  const Eigen::Matrix2d prior = landmark().covariance_m2.inverse();
  const Eigen::Matrix2d seen = from_measurement.covariance_m2.inverse();
  const Eigen::Matrix2d covariance_m2 = (prior + seen).inverse();
  EXPECT_TRUE(result.covariance_m2.isApprox(covariance_m2, 1e-9));
  const Eigen::Vector2d mean_m =
      covariance_m2 * (prior * landmark().mean_m + seen * from_measurement.mean_m);
  EXPECT_TRUE(result.mean_m.isApprox(mean_m, 1e-9));
}

TEST(Corrected, IsTheInformationFormOfTheSameUpdate) {
  PoseWithCovariance2 pose{kPose, Eigen::Matrix3d::Zero()};
  pose.covariance.diagonal() << 0.01, 0.02, 0.001;
  const Innovation found = innovation(pose, landmark(), measured());
  const PoseWithCovariance2 result = corrected(pose, found);
  // P'^-1 = P^-1 + H^T Q^-1 H, Q the innovation of a known pose (Montemerlo et al., 2003, eq. 13).
  const Eigen::Matrix2d known_m2 = innovation(kPose, landmark(), measured()).covariance_m2;
  const Eigen::Matrix3d information =
      pose.covariance.inverse() + found.by_pose.transpose() * known_m2.inverse() * found.by_pose;
  EXPECT_TRUE(result.covariance.isApprox(information.inverse(), 1e-9));
  const Eigen::Vector3d step =
      information.inverse() * found.by_pose.transpose() * known_m2.inverse() * found.residual_m;
  EXPECT_LT((componentDifference(result.pose, kPose) - step).norm(), 1e-12);
}

TEST(CreateLandmark, TurnsTheNoiseIntoTheMap) {
  const Landmark created = createLandmark({1.0, 2.0, M_PI_2}, measured());
  EXPECT_TRUE(created.mean_m.isApprox(Eigen::Vector2d(1.0 - 0.9, 2.0 + 3.4), 1e-12));
  Eigen::Matrix2d wanted;
  wanted << 0.002, -0.001, -0.001, 0.003;
  EXPECT_TRUE(created.covariance_m2.isApprox(wanted, 1e-12));
}

}  // namespace
}  // namespace ram_slam
