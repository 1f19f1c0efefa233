// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/feature.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr std::int64_t kIntervalNs = 100'000'000;

TEST(OrientationLogRatio, IsThatOfANormalDistributionToAUniformOne) {
  const double density = std::exp(-0.5 * 0.04 / 0.01) / std::sqrt(2.0 * M_PI * 0.01);
  EXPECT_NEAR(orientationLogRatio(0.2, 0.01, 0.0), std::log(2.0 * M_PI * density), 1e-12);
  EXPECT_NEAR(orientationLogRatio(2.0 * M_PI - 0.2, 0.01, 0.0), orientationLogRatio(0.2, 0.01, 0.0),
              1e-9);
}

TEST(OrientationLogRatio, IsAtLeastTheLogarithmOfTheWrongShare) {
  EXPECT_NEAR(orientationLogRatio(M_PI, 0.01, 0.001), std::log(0.001), 1e-9);
}

TEST(OrientationLogRatio, IsNoEvidenceIfAnOrientationWasNotObserved) {
  EXPECT_EQ(orientationLogRatio(0.0, 1.01, 0.001), 0.0);
  EXPECT_EQ(orientationLogRatio(0.0, 1e6, 0.001), 0.0);
}

TEST(OrientationLogRatio, HasAMeanLikelihoodRatioOfOneOverAllOrientations) {
  // The normal density integrates to 1, so that the ratio averages to 1 over a whole turn.
  constexpr int kSteps = 1000;
  double mean = 0.0;
  for (int i = 0; i < kSteps; ++i)
    mean += std::exp(orientationLogRatio(2.0 * M_PI * i / kSteps, 0.04, 0.01)) / kSteps;
  EXPECT_NEAR(mean, 1.0, 1e-9);
}

FeatureList oneFeatureAfter(std::int64_t delay_ns) {
  FeatureList list;
  list.features.resize(1);
  list.features[0].position_m = {2.0, 0.0};
  list.features[0].covariance_m2 = Eigen::Vector2d(0.04, 0.01).asDiagonal();
  list.features[0].delay_ns = delay_ns;
  return list;
}

TEST(Deskew, AddsTheWayDrivenSinceTheStampOfTheList) {
  const FeatureList moved = deskew(oneFeatureAfter(kIntervalNs / 2), {0.2, 0.0, 0.0}, kIntervalNs);
  EXPECT_NEAR(moved.features[0].position_m.x(), 2.1, 1e-12);
  EXPECT_EQ(moved.features[0].delay_ns, 0);
}

TEST(Deskew, TurnsPositionCovarianceAndOrientation) {
  const FeatureList moved = deskew(oneFeatureAfter(kIntervalNs), {0.0, 0.0, M_PI_2}, kIntervalNs);
  EXPECT_TRUE(moved.features[0].position_m.isApprox(Eigen::Vector2d(0.0, 2.0), 1e-12));
  const Eigen::Matrix2d wanted = Eigen::Vector2d(0.01, 0.04).asDiagonal();
  EXPECT_TRUE(moved.features[0].covariance_m2.isApprox(wanted, 1e-12));
  EXPECT_NEAR(moved.features[0].orientation_rad, M_PI_2, 1e-12);
}

TEST(Deskew, LeavesFeaturesWhereTheyAreAfterAnIntervalOfMoreThanASecond) {
  const FeatureList kept = deskew(oneFeatureAfter(kIntervalNs), {1.0, 0.0, 1.0}, 1'000'000'001);
  EXPECT_EQ(kept.features[0].position_m, Eigen::Vector2d(2.0, 0.0));
}

}  // namespace
}  // namespace ram_slam
