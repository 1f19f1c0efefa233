// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_adjustment.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "ram_slam/smoothing/feature_pairing.hpp"

#include "rest_problem.hpp"

namespace ram_slam {
namespace {

using ::testing::ElementsAre;

/// One landmark seen twice, 0.4 m apart, with variances of 1 and 3 m^2.
RestProblem twoReadings() {
  RestProblem rest({{pole({20.0, 0.0}, 1.0)}, {pole({20.4, 0.0}, std::sqrt(3.0))}});
  rest.landmarks = {poleAt(0, {20.3, 0.1})};
  rest.parameters.robust_chi2 = 1e6;
  return rest;
}

LandmarkProblem paired(const RestProblem& rest) {
  LandmarkProblem problem = rest.make();
  FeaturePairing(rest.parameters).pair(problem);
  return problem;
}

TEST(Adjust, PutsALandmarkAtTheMeanWeightedByInformation) {
  const RestProblem rest = twoReadings();
  LandmarkProblem problem = paired(rest);
  adjust(problem, rest.parameters);
  EXPECT_NEAR(problem.landmarks[0].mean_m.x(), 20.1, 1e-3);
  EXPECT_NEAR(problem.landmarks[0].mean_m.y(), 0.0, 1e-3);
  // Half the sum of squares (0.1^2 / 1 + 0.3^2 / 3), a fifth of which counts.
  EXPECT_NEAR(problem.cost, 0.5 * 0.2 * (0.01 + 0.03), 1e-5);
}

TEST(Adjust, KeepsTheFirstPose) {
  const RestProblem rest = twoReadings();
  LandmarkProblem problem = paired(rest);
  adjust(problem, rest.parameters);
  EXPECT_THAT(problem.poses[0], ElementsAre(0.0, 0.0, 0.0));
}

TEST(Adjust, FollowsTheOdometryWithoutPairs) {
  RestProblem rest({{}, {}});
  rest.steps[1].motion.pose = {1.0, 0.5, 0.2};
  LandmarkProblem problem = rest.make();
  adjust(problem, rest.parameters);
  EXPECT_NEAR(problem.poses[1][0], 1.0, 1e-6);
  EXPECT_NEAR(problem.poses[1][1], 0.5, 1e-6);
  EXPECT_NEAR(problem.poses[1][2], 0.2, 1e-6);
  EXPECT_NEAR(problem.cost, 0.0, 1e-9);
}

TEST(Adjust, CauchyKernelHoldsAWrongReadingAtBay) {
  RestProblem rest(std::vector<std::vector<Feature>>(5, {pole({5.0, 0.0}, 0.1)}));
  rest.steps[4].list.features[0].position_m.x() = 5.3;
  rest.landmarks = {poleAt(0, {5.0, 0.0})};
  LandmarkProblem problem = paired(rest);
  rest.parameters.robust_chi2 = 0.01;
  adjust(problem, rest.parameters);
  EXPECT_LT(problem.landmarks[0].mean_m.x(), 5.02);  // the plain mean is 5.06
}

TEST(PairedLandmarks, AreThoseWithAFeature) {
  RestProblem rest = twoReadings();
  rest.landmarks.push_back(poleAt(1, {-50.0, 0.0}));
  EXPECT_THAT(pairedLandmarks(paired(rest)), ElementsAre(true, false));
}

TEST(ComputeCovariances, AreTheInverseOfTheSummedInformation) {
  RestProblem rest = twoReadings();
  rest.landmarks.push_back(poleAt(1, {-50.0, 0.0}));
  LandmarkProblem problem = paired(rest);
  adjust(problem, rest.parameters);
  computeCovariances(problem, rest.parameters);
  // A fifth of 1 + 1/3 is new.
  const Eigen::Matrix2d wanted = 5.0 / (1.0 + 1.0 / 3.0) * Eigen::Matrix2d::Identity();
  EXPECT_LT((problem.landmarks[0].covariance_m2 - wanted).norm(), 0.01);
  EXPECT_EQ(problem.landmarks[1].covariance_m2, Eigen::Matrix2d::Identity());  // as it was
}

}  // namespace
}  // namespace ram_slam
