// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ukf_localiser/sigma_points.hpp"

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

PoseWithCovariance2 uncertainPose() {
  PoseWithCovariance2 pose{{3.0, -2.0, 3.1}, Eigen::Matrix3d::Zero()};
  pose.covariance << 0.04, 0.01, 0.002, 0.01, 0.02, -0.001, 0.002, -0.001, 0.003;
  return pose;
}

TEST(SigmaPoints, HaveTheMomentsOfTheDistribution) {
  const PoseWithCovariance2 pose = uncertainPose();
  const std::vector<Pose2> points = sigmaPoints(pose);
  EXPECT_EQ(points.size(), 6u);
  const PoseWithCovariance2 moments = momentsOf(points);
  EXPECT_NEAR(componentDifference(moments.pose, pose.pose).norm(), 0.0, 1e-12)
      << "across +-pi, too";
  EXPECT_NEAR((moments.covariance - pose.covariance).norm(), 0.0, 1e-12);
}

TEST(SigmaPoints, MovedOneByOneAgreeWithTheLinearisedMotionWhereItIsGood) {
  PoseWithCovariance2 pose = uncertainPose();
  pose.covariance = Eigen::Vector3d(0.05 * 0.05, 0.05 * 0.05, 0.05 * 0.05).asDiagonal();
  const PoseWithCovariance2 motion{{0.5, 0.1, 0.2}, Eigen::Matrix3d::Zero()};
  std::vector<Pose2> points = sigmaPoints(pose);
  for (Pose2& point : points) point = point * motion.pose;
  const PoseWithCovariance2 moments = momentsOf(points);
  const PoseWithCovariance2 linear = pose * motion;
  EXPECT_NEAR(componentDifference(moments.pose, linear.pose).norm(), 0.0, 1e-3);
  EXPECT_NEAR((moments.covariance - linear.covariance).norm() / linear.covariance.norm(), 0.0,
              0.01);
}

TEST(SigmaPoints, CorrectAsTheKalmanFilterWhereThePoseKnowsItsYaw) {
  PoseWithCovariance2 pose{{1.0, 2.0, 0.5}, Eigen::Matrix3d::Zero()};
  pose.covariance(0, 0) = pose.covariance(1, 1) = 0.09;
  const Landmark landmark{{4.0, 3.0}, 0.04 * Eigen::Matrix2d::Identity()};
  const PointMeasurement measured{pose.pose.inverse() * Eigen::Vector2d(4.2, 3.1),
                                  0.01 * Eigen::Matrix2d::Identity()};
  const PoseWithCovariance2 after =
      correctedBy(pose, {{landmark, measured}}, Eigen::Matrix2d::Zero());
  const PoseWithCovariance2 wanted = corrected(pose, innovation(pose, landmark, measured));
  EXPECT_NEAR(componentDifference(after.pose, wanted.pose).norm(), 0.0, 1e-9);
  EXPECT_NEAR((after.covariance - wanted.covariance).norm(), 0.0, 1e-9);
  EXPECT_NEAR(after.covariance(0, 0), 0.09 * 0.05 / 0.14, 1e-9) << "1 / (1 / 0.09 + 1 / 0.05)";
}

TEST(SigmaPoints, LearnLessFromLandmarksWhoseErrorsAreOne) {
  const PoseWithCovariance2 pose = uncertainPose();
  std::vector<MapSighting> two;
  for (const double y_m : {-3.0, 1.0}) {
    const Eigen::Vector2d place_m = pose.pose * Eigen::Vector2d(2.0, y_m);
    two.push_back({{place_m, 0.04 * Eigen::Matrix2d::Identity()},
                   {{2.0, y_m}, 0.01 * Eigen::Matrix2d::Identity()}});
  }
  Eigen::Matrix4d common = Eigen::Matrix4d::Zero();
  const auto uncertainty = [&] {
    return correctedBy(pose, two, common).covariance.topLeftCorner<2, 2>().trace();
  };
  const double independent = uncertainty();
  common.block<2, 2>(0, 2) = common.block<2, 2>(2, 0) = 0.039 * Eigen::Matrix2d::Identity();
  EXPECT_GT(uncertainty(), independent);
  common *= 3.0;  // no covariance
  EXPECT_NEAR(uncertainty(), independent, 1e-12);
}

}  // namespace
}  // namespace ram_slam
