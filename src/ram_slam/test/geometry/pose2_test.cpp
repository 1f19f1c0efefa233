// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/pose2.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

constexpr double kRoundingOnly = 1e-12;

void expectNear(const Pose2& a, const Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x_m, b.x_m, tolerance);
  EXPECT_NEAR(a.y_m, b.y_m, tolerance);
  EXPECT_NEAR(wrapAngle(a.yaw_rad - b.yaw_rad), 0.0, tolerance);
}

Pose2 randomPose(Random& random) {
  return {10.0 * random.gaussian(), 10.0 * random.gaussian(),
          M_PI * (2.0 * random.uniform() - 1.0)};
}

TEST(WrapAngle, StaysInTheHalfOpenTurn) {
  EXPECT_EQ(wrapAngle(M_PI), M_PI);
  EXPECT_EQ(wrapAngle(-M_PI), M_PI);
  EXPECT_NEAR(wrapAngle(7.0), 7.0 - 2.0 * M_PI, kRoundingOnly);
  EXPECT_NEAR(wrapAngle(1e6 * 2.0 * M_PI + 1.0), 1.0, 1e-8);
}

TEST(Pose2, InverseUndoesThePose) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose2 pose = randomPose(random);
    expectNear(pose * pose.inverse(), {}, kRoundingOnly);
    expectNear(pose.inverse() * pose, {}, kRoundingOnly);
  }
}

TEST(Pose2, TurnsComponentsIntoTheAxesOfTheFrameThatItIsSeenFrom) {
  // A quarter turn: what points along x points along y; the yaw stays what it is.
  const Eigen::Matrix3d turn = Pose2{3.0, 4.0, M_PI_2}.axesRotation();
  EXPECT_TRUE((turn * Eigen::Vector3d(1.0, 2.0, 0.3)).isApprox(Eigen::Vector3d(-2.0, 1.0, 0.3)));
  const Eigen::Matrix3d along_x = Eigen::Vector3d(4.0, 1.0, 9.0).asDiagonal();
  const Eigen::Matrix3d along_y = Eigen::Vector3d(1.0, 4.0, 9.0).asDiagonal();
  EXPECT_TRUE((turn * along_x * turn.transpose()).isApprox(along_y));
}

TEST(Pose2, ComposesAsPointsDo) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Pose2 a = randomPose(random);
    const Pose2 b = randomPose(random);
    const Eigen::Vector2d point(random.gaussian(), random.gaussian());
    EXPECT_NEAR(((a * b) * point - a * (b * point)).norm(), 0.0, 1e-10);
  }
}

TEST(Exponential, QuarterCircleEndsOneRadiusAheadAndOneToTheLeft) {
  const double radius_m = 2.0;
  expectNear(exponential({radius_m * M_PI_2, 0.0, M_PI_2}), {radius_m, radius_m, M_PI_2},
             kRoundingOnly);
}

TEST(Exponential, LogarithmIsItsInverse) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Pose2 pose = randomPose(random);
    expectNear(exponential(logarithm(pose)), pose, 1e-10);
  }
  const Pose2 tiny{1.0, 2.0, 1e-9};
  expectNear(exponential(logarithm(tiny)), tiny, kRoundingOnly);
}

TEST(Interpolate, MidpointOfASemicircleLiesOnTheCircleNotOnTheChord) {
  const Pose2 start;
  const Pose2 end = exponential({M_PI * 0.999999, 0.0, M_PI * 0.999999});
  const Pose2 middle = interpolate(start, end, 0.5);
  EXPECT_NEAR((middle.translation() - Eigen::Vector2d(0.0, 1.0)).norm(), 1.0, 1e-6);
  EXPECT_NEAR(middle.x_m, 1.0, 1e-5);
}

TEST(Pose2, AMotionContinuesAtItsTwist) {
  const Pose2 motion = exponential({0.2, 0.0, 0.4});
  const Pose2 half = exponential({0.1, 0.0, 0.2});
  const Pose2 found = continued(motion, 200'000'000, 100'000'000);
  EXPECT_LT(logarithm(half.inverse() * found).norm(), 1e-12);
  EXPECT_EQ(continued(motion, 0, 100'000'000).yaw_rad, 0.0);
  EXPECT_EQ(continued(motion, 2'000'000'000, 100'000'000).yaw_rad, 0.0);
}

TEST(PoseWithCovariance2, CompositionMatchesSampling) {
  PoseWithCovariance2 a;
  a.pose = {1.0, -2.0, 0.7};
  a.covariance.diagonal() << 1e-4, 4e-4, 1e-4;
  a.covariance(0, 2) = a.covariance(2, 0) = 5e-5;
  PoseWithCovariance2 b;
  b.pose = {3.0, 0.5, -0.4};
  b.covariance.diagonal() << 2e-4, 1e-4, 2e-4;
  const PoseWithCovariance2 composed = a * b;

  Random random(4);
  const int samples = 100000;
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  for (int i = 0; i < samples; ++i) {
    const Eigen::Vector3d da = random.gaussian(a.covariance);
    const Eigen::Vector3d db = random.gaussian(b.covariance);
    const Pose2 pose = Pose2{a.pose.x_m + da.x(), a.pose.y_m + da.y(), a.pose.yaw_rad + da.z()} *
                       Pose2{b.pose.x_m + db.x(), b.pose.y_m + db.y(), b.pose.yaw_rad + db.z()};
    const Eigen::Vector3d error(pose.x_m - composed.pose.x_m, pose.y_m - composed.pose.y_m,
                                wrapAngle(pose.yaw_rad - composed.pose.yaw_rad));
    sampled += error * error.transpose() / samples;
  }
  EXPECT_LT((sampled - composed.covariance).norm(), 0.02 * composed.covariance.norm());
}

TEST(Random, IsFixedByItsKeyAndDiffersBetweenKeys) {
  Random a(1, 2, 3);
  Random b(1, 2, 3);
  Random c(1, 3, 2);
  EXPECT_EQ(a(), b());
  EXPECT_NE(a(), c());
}

TEST(Random, GaussianHasTheGivenCovariance) {
  Eigen::Matrix3d covariance;
  covariance << 4.0, 1.0, 0.5, 1.0, 2.0, 0.0, 0.5, 0.0, 1.0;
  Random random(5);
  const int samples = 200000;
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  for (int i = 0; i < samples; ++i) {
    const Eigen::Vector3d draw = random.gaussian(covariance);
    sampled += draw * draw.transpose() / samples;
  }
  EXPECT_LT((sampled - covariance).cwiseAbs().maxCoeff(), 0.05);
}

TEST(WrapAngle, IsTheAngleOfItsSineAndCosine) {
  for (double angle_rad = -40.0; angle_rad < 40.0; angle_rad += 0.37)
    EXPECT_NEAR(wrapAngle(angle_rad), std::atan2(std::sin(angle_rad), std::cos(angle_rad)), 1e-12);
}

TEST(Exponential, IsTheLimitOfManySmallSteps) {
  // dx/dt = R(yaw) v, dyaw/dt = w over unit time, by the midpoint rule.
  const Eigen::Vector3d twist(1.3, -0.4, 2.1);
  constexpr int kSteps = 20000;
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double yaw = twist.z() * (i + 0.5) / kSteps;
    x += (std::cos(yaw) * twist.x() - std::sin(yaw) * twist.y()) / kSteps;
    y += (std::sin(yaw) * twist.x() + std::cos(yaw) * twist.y()) / kSteps;
  }
  expectNear(exponential(twist), {x, y, twist.z()}, 1e-8);
}

TEST(Logarithm, OfTheInverseIsTheTwistBackwards) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Pose2 pose = randomPose(random);
    EXPECT_LT((logarithm(pose.inverse()) + logarithm(pose)).norm(), 1e-9);
  }
  EXPECT_EQ(logarithm(Pose2{}).norm(), 0.0);
}

TEST(Interpolate, BeginsAndEndsAtItsPosesAndContinuesBeyondThem) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Pose2 a = randomPose(random);
    const Pose2 b = a * exponential({random.gaussian(), random.gaussian(), random.uniform()});
    expectNear(interpolate(a, b, 0.0), a, 1e-10);
    expectNear(interpolate(a, b, 1.0), b, 1e-10);
    expectNear(interpolate(a, b, 2.0), b * (a.inverse() * b), 1e-9);
    expectNear(interpolate(a, b, 0.3), interpolate(b, a, 0.7), 1e-9);
  }
}

TEST(ComponentDifference, TakesTheShortWayRound) {
  const Eigen::Vector3d difference = componentDifference({1.0, 2.0, 3.1}, {0.5, 4.0, -3.1});
  EXPECT_NEAR(difference.x(), 0.5, 1e-15);
  EXPECT_NEAR(difference.y(), -2.0, 1e-15);
  EXPECT_NEAR(difference.z(), 6.2 - 2.0 * M_PI, 1e-12);
}

TEST(Pose2, CompositionIsAssociativeAndReversesInTheInverse) {
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    const Pose2 a = randomPose(random);
    const Pose2 b = randomPose(random);
    const Pose2 c = randomPose(random);
    expectNear((a * b) * c, a * (b * c), 1e-10);
    expectNear((a * b).inverse(), b.inverse() * a.inverse(), 1e-10);
  }
}

TEST(PoseWithCovariance2, CompositionWithAPoseThatIsCertainTurnsOrLeversTheOther) {
  PoseWithCovariance2 certain;
  certain.pose = {0.0, 0.0, M_PI_2};
  PoseWithCovariance2 uncertain;
  uncertain.pose = {2.0, 0.0, 0.0};
  uncertain.covariance.diagonal() << 0.04, 0.01, 0.25;
  // Turned by a quarter: the variances along x and y change places.
  const PoseWithCovariance2 turned = certain * uncertain;
  EXPECT_NEAR(turned.covariance(0, 0), 0.01, kRoundingOnly);
  EXPECT_NEAR(turned.covariance(1, 1), 0.04, kRoundingOnly);
  EXPECT_NEAR(turned.covariance(2, 2), 0.25, kRoundingOnly);
  // A lever of 2 m turns an uncertain yaw into a position across it: variance 0.01 + 2^2 0.25.
  PoseWithCovariance2 ahead;
  ahead.pose = {2.0, 0.0, 0.0};
  uncertain.pose = {};
  const PoseWithCovariance2 levered = uncertain * ahead;
  EXPECT_NEAR(levered.covariance(0, 0), 0.04, kRoundingOnly);
  EXPECT_NEAR(levered.covariance(1, 1), 1.01, kRoundingOnly);
  EXPECT_NEAR(levered.covariance(1, 2), 0.5, kRoundingOnly);
}

}  // namespace
}  // namespace ram_slam
