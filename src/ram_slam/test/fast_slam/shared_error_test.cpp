// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/shared_error.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr double kFloor_m = 0.01;

double sigma_m(const SharedError& error) {
  return std::sqrt(error.covariance(kFloor_m)(0, 0));
}

/// Along the x axis, so many steps of 0.1 m.
void drive(SharedError& error, double& x_m, int steps) {
  const double step_m = steps < 0 ? -0.1 : 0.1;
  for (int i = 0; i < std::abs(steps); ++i) {
    x_m += step_m;
    error.move(0.1, {x_m, 0.0});
  }
}

Trajectory alongX(double from_m, double to_m) {
  Trajectory trajectory;
  for (int i = 0; from_m + 0.1 * i < to_m + 1e-9; ++i)
    trajectory.push_back({i + 1, {from_m + 0.1 * i, 0.0, 0.0}});
  return trajectory;
}

TEST(SharedError, GrowsLinearlyInVarianceFromHalfTheFloorToTwiceIt) {
  SharedError error;
  double x_m = 0.0;
  EXPECT_NEAR(sigma_m(error), 0.5 * kFloor_m, 1e-12);
  drive(error, x_m, 250);
  EXPECT_NEAR(std::pow(sigma_m(error), 2), 0.5 * (0.25 + 4.0) * kFloor_m * kFloor_m, 1e-12);
  drive(error, x_m, 250);
  EXPECT_NEAR(sigma_m(error), 2.0 * kFloor_m, 1e-12);
  drive(error, x_m, 250);
  EXPECT_NEAR(sigma_m(error), 2.0 * kFloor_m, 1e-12);
}

TEST(SharedError, IsTheSameInXAndYAndThatOfAFeatureFiveMetresAwayInYaw) {
  const Eigen::Matrix3d covariance = SharedError().covariance(kFloor_m);
  const Eigen::Matrix3d wanted =
      Eigen::Vector3d(25e-6, 25e-6, 1e-6).asDiagonal();  // (0.5 cm)^2, (0.5 cm / 5 m)^2
  EXPECT_NEAR((covariance - wanted).norm(), 0.0, 1e-15);
  EXPECT_TRUE(SharedError().covariance(0.0).isZero(0.0));
}

TEST(SharedError, FallsWhereASmootherWasFollowedAndGrowsAgainBeyond) {
  SharedError error;
  double x_m = 0.0;
  drive(error, x_m, 300);
  EXPECT_GT(sigma_m(error), kFloor_m);
  error.follow(alongX(0.0, x_m));
  drive(error, x_m, 1);
  EXPECT_NEAR(sigma_m(error), 0.5 * kFloor_m, 1e-12);
  drive(error, x_m, 300);  // 2 m of them are as good as on known ground
  EXPECT_GT(sigma_m(error), 1.5 * kFloor_m);
  drive(error, x_m, -301);
  EXPECT_NEAR(sigma_m(error), 0.5 * kFloor_m, 1e-12);
}

TEST(SharedError, BesideACorrectedTrajectoryGroundIsNew) {
  SharedError error;
  error.follow(alongX(0.0, 10.0));
  error.move(50.0, {5.0, 2.5});
  EXPECT_NEAR(sigma_m(error), 2.0 * kFloor_m, 1e-12);
  error.move(0.1, {5.0, 1.5});
  EXPECT_NEAR(sigma_m(error), 0.5 * kFloor_m, 1e-12);
}

TEST(SharedError, ATrajectoryReplacesTheOneBefore) {
  SharedError error;
  error.follow(alongX(0.0, 10.0));
  error.follow(alongX(20.0, 30.0));
  error.move(50.0, {5.0, 0.0});
  EXPECT_NEAR(sigma_m(error), 2.0 * kFloor_m, 1e-12);
}

TEST(SharedError, AMapFromElsewhereIsNewGroundUntilASmootherIsFollowed) {
  SharedError error;
  error.follow(alongX(0.0, 10.0));
  error.forget();
  EXPECT_NEAR(sigma_m(error), 2.0 * kFloor_m, 1e-12);
  error.move(0.1, {5.0, 0.0});
  EXPECT_NEAR(sigma_m(error), 2.0 * kFloor_m, 1e-12);
  error.follow(alongX(0.0, 10.0));
  error.move(0.1, {5.0, 0.0});
  EXPECT_NEAR(sigma_m(error), 0.5 * kFloor_m, 1e-12);
}

}  // namespace
}  // namespace ram_slam
