// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/feature_pairing.hpp"

#include <gmock/gmock.h>

#include "rest_problem.hpp"

namespace ram_slam {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kDeviationM = 0.1;

/// Landmarks count as known exactly, so that chi2 is that of the feature alone.
FeaturePairing exactPairing(const RestProblem& rest) {
  FeaturePairing pairing(rest.parameters);
  pairing.setDeviation(0.0);
  return pairing;
}

TEST(FeaturePairing, ScoreIsHalfOfWhatTheGateExceedsTheSquaredDistanceBy) {
  const RestProblem rest({{pole({1.0, 0.0}, kDeviationM)}});
  const LandmarkProblem problem = rest.make();
  const FeaturePairing pairing = exactPairing(rest);
  // 2 deviations away: (16 - 4) / 2. At 4 deviations the gate is reached.
  EXPECT_NEAR(pairing.score(problem, problem.readings[0], {1.2, 0.0}), 6.0, 1e-9);
  EXPECT_NEAR(pairing.score(problem, problem.readings[0], {1.0, 0.0}), 8.0, 1e-9);
  EXPECT_EQ(pairing.score(problem, problem.readings[0], {1.0, 0.45}), 0.0);
  EXPECT_EQ(pairing.score(problem, problem.readings[0], {50.0, 0.0}), 0.0);
}

TEST(FeaturePairing, DeviationOfLandmarksWidensTheGate) {
  const RestProblem rest({{pole({1.0, 0.0}, kDeviationM)}});
  const LandmarkProblem problem = rest.make();
  FeaturePairing pairing(rest.parameters);
  pairing.setDeviation(kDeviationM);
  // chi2 = 0.4^2 / (2 * 0.1^2) = 8
  EXPECT_NEAR(pairing.score(problem, problem.readings[0], {1.4, 0.0}), 4.0, 1e-9);
}

TEST(FeaturePairing, PairsEachLandmarkOncePerListWithTheLargestSum) {
  // Both features are nearest to the first landmark; only together they fit.
  RestProblem rest({{pole({1.0, 0.0}, kDeviationM), pole({1.12, 0.0}, kDeviationM)}});
  rest.landmarks = {poleAt(0, {1.05, 0.0}), poleAt(1, {1.3, 0.0})};
  LandmarkProblem problem = rest.make();
  exactPairing(rest).pair(problem);
  EXPECT_EQ(problem.readings[0].landmark, 0U);
  EXPECT_EQ(problem.readings[1].landmark, 1U);
}

TEST(FeaturePairing, LandmarksOfAnotherListAreFree) {
  RestProblem rest({{pole({1.0, 0.0}, kDeviationM)}, {pole({1.1, 0.0}, kDeviationM)}});
  rest.landmarks = {poleAt(0, {1.0, 0.0})};
  LandmarkProblem problem = rest.make();
  exactPairing(rest).pair(problem);
  EXPECT_EQ(problem.readings[0].landmark, 0U);
  EXPECT_EQ(problem.readings[1].landmark, 0U);
}

TEST(FeaturePairing, TypesAreNotMixed) {
  RestProblem rest({{pole({1.0, 0.0}, kDeviationM)}});
  rest.landmarks = {poleAt(0, {1.0, 0.0})};
  rest.landmarks[0].type = "corner";
  LandmarkProblem problem = rest.make();
  exactPairing(rest).pair(problem);
  EXPECT_FALSE(problem.readings[0].isPaired());
}

TEST(FeaturePairing, EvidenceIsTheShareBeyondTheNextBestLandmark) {
  RestProblem rest({{pole({1.0, 0.0}, kDeviationM)}});
  rest.landmarks = {poleAt(0, {1.0, 0.0}), poleAt(1, {1.2, 0.0})};
  LandmarkProblem problem = rest.make();
  exactPairing(rest).pair(problem);
  // Scores 8 and 6; a fifth of the difference, and nothing for the other.
  const std::vector<double> evidence = exactPairing(rest).evidence(problem);
  ASSERT_THAT(evidence, SizeIs(2));
  EXPECT_NEAR(evidence[0], 0.2 * 2.0, 1e-9);
  EXPECT_EQ(evidence[1], 0.0);
}

TEST(FeaturePairing, RevisionRemovesGhostsAndMakesWhatIsMissing) {
  // Five sightings explain 5 * 0.2 * 8 nat = 8 nat: enough for one landmark.
  RestProblem rest(std::vector<std::vector<Feature>>(5, {pole({1.0, 2.0}, kDeviationM)}));
  rest.landmarks = {poleAt(3, {9.0, 9.0})};
  LandmarkProblem problem = rest.make();
  exactPairing(rest).revise(problem);
  ASSERT_THAT(problem.landmarks, SizeIs(1));
  EXPECT_EQ(problem.landmarks[0].id, 4);
  EXPECT_EQ(problem.landmarks[0].type, "pole");
  EXPECT_EQ(problem.landmarks[0].placed_ns, 1);
  EXPECT_TRUE(problem.landmarks[0].mean_m.isApprox(Eigen::Vector2d(1.0, 2.0)));
  for (const FeatureReading& reading : problem.readings) EXPECT_TRUE(reading.isPaired());
}

TEST(FeaturePairing, RevisionMakesNothingOfTooFewFeatures) {
  RestProblem rest(std::vector<std::vector<Feature>>(4, {pole({1.0, 2.0}, kDeviationM)}));
  LandmarkProblem problem = rest.make();
  exactPairing(rest).revise(problem);
  EXPECT_THAT(problem.landmarks, IsEmpty());
}

}  // namespace
}  // namespace ram_slam
