// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/map_drift.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

const PoseWithCovariance2 kStep{{1.0, 0.2, 0.3}, Eigen::Vector3d(1e-4, 2e-4, 3e-5).asDiagonal()};

TEST(MapDrift, GrowsAsThePosesCovarianceDoesWithoutLandmarks) {
  PoseWithCovariance2 pose{{3.0, -2.0, 1.0}, Eigen::Vector3d(1e-3, 1e-3, 1e-4).asDiagonal()};
  MapDrift drift(2.0);
  drift.reset(pose);
  for (int i = 0; i < 20; ++i) {
    drift.move(pose.pose, kStep);
    pose = pose * kStep;
    EXPECT_NEAR((drift.at(pose.pose) - pose.covariance).norm(), 0.0, 1e-12);
  }
}

TEST(MapDrift, FallsBackToWhatItWasWhenLandmarksOfThenAreSeen) {
  MapDrift drift(2.0);
  Pose2 pose;
  drift.move(pose, kStep);
  pose = pose * kStep.pose;
  const Eigen::Matrix3d then = drift.covariance();
  const Pose2 there = pose;
  for (int i = 0; i < 20; ++i) {
    drift.move(pose, kStep);
    pose = pose * kStep.pose;
  }
  const Eigen::Matrix3d local = 1e-6 * Eigen::Matrix3d::Identity();
  drift.fallBack(then, {there, local});
  EXPECT_NEAR((drift.at(there) - kStep.covariance - local).norm(), 0.0, 1e-9);
  const Eigen::Matrix3d least = drift.covariance();
  drift.fallBack(100.0 * then, {there, local});  // has no effect
  EXPECT_EQ(drift.covariance(), least);
}

TEST(MapDrift, AClosedLoopCorrectsItsMiddleAsABrownianBridgeDoes) {
  const Eigen::Matrix3d step = Eigen::Vector3d(1e-4, 1e-4, 0.0).asDiagonal();
  MapDrift open(2.0);
  Eigen::Matrix3d middle, early;
  for (int i = 0; i < 100; ++i) {
    if (i == 25) early = open.covariance();
    if (i == 50) middle = open.covariance();
    open.move({}, {{}, step});
  }
  MapDrift closed = open;
  closed.fallBack(Eigen::Matrix3d::Zero(), {{}, Eigen::Matrix3d::Zero()});
  // t (T - t) / T of the variance per step
  EXPECT_NEAR((closed.bridged(middle, open, {}) - 25.0 * step).norm(), 0.0, 1e-12);
  EXPECT_NEAR((closed.bridged(early, open, {}) - 18.75 * step).norm(), 0.0, 1e-12);
  EXPECT_EQ(open.bridged(middle, open, {}), middle);  // nothing was closed
}

TEST(MapDrift, IsNeverLessThanThePosesOwnCovariance) {
  MapDrift drift(2.0);
  const PoseWithCovariance2 pose{{5.0, 1.0, 2.0}, 0.01 * Eigen::Matrix3d::Identity()};
  drift.cover(pose);
  EXPECT_NEAR((drift.at(pose.pose) - pose.covariance).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace ram_slam
