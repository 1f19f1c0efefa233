// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_perturbation.hpp"

#include <gmock/gmock.h>

#include "ram_slam/smoothing/landmark_adjustment.hpp"

#include "rest_problem.hpp"

namespace ram_slam {
namespace {

using ::testing::SizeIs;

constexpr double kDeviationM = 0.1;

TEST(Objective, CountsCostUnpairedFeaturesAndLandmarks) {
  RestProblem rest({{pole({1.0, 0.0}, kDeviationM), pole({5.0, 0.0}, kDeviationM)}});
  rest.landmarks = {poleAt(0, {1.0, 0.0})};
  LandmarkProblem problem = rest.make();
  FeaturePairing(rest.parameters).pair(problem);
  problem.cost = 2.5;
  // One feature of two is unpaired: half the gate, a fifth of which counts.
  EXPECT_NEAR(objective(problem, rest.parameters), 2.5 + 0.5 * 0.2 * 16.0 + 7.0, 1e-9);
}

TEST(ShiftPart, MovesOneStretchByOneVectorAndNeverTheFirstPose) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    LandmarkProblem problem = RestProblem(std::vector<std::vector<Feature>>(20)).make();
    Random random(seed);
    shiftPart(problem, 1.0, random);
    EXPECT_EQ(problem.poses[0][0], 0.0);
    double shift_m = 0.0;
    int changes = 0;
    for (std::size_t i = 1; i < problem.poses.size(); ++i) {
      if (problem.poses[i][0] != 0.0) shift_m = problem.poses[i][0];
      if (problem.poses[i][0] != problem.poses[i - 1][0]) ++changes;
    }
    EXPECT_NE(shift_m, 0.0);
    EXPECT_GE(changes, 1);
    EXPECT_LE(changes, 2);
    for (const auto& pose : problem.poses) EXPECT_TRUE(pose[0] == 0.0 || pose[0] == shift_m);
  }
}

/// Five sightings of one pole, for which there are two landmarks.
struct Duplicate {
  RestProblem rest{std::vector<std::vector<Feature>>(5, {pole({1.0, 0.0}, kDeviationM)})};
  FeaturePairing pairing{rest.parameters};

  Duplicate() {
    rest.landmarks = {poleAt(0, {1.0, 0.0}), poleAt(1, {1.0, 0.01})};
    rest.parameters.perturbation.removal_share = 1.0;
    pairing = FeaturePairing(rest.parameters);
    pairing.setDeviation(0.02);
  }

  LandmarkProblem solved() const {
    LandmarkProblem problem = rest.make();
    pairing.pair(problem);
    adjust(problem, rest.parameters);
    return problem;
  }
};

TEST(Perturb, LeavesOutALandmarkThatIsThereTwice) {
  const Duplicate duplicate;
  LandmarkProblem problem = duplicate.solved();
  const double before = objective(problem, duplicate.rest.parameters);
  EXPECT_TRUE(perturb(problem, duplicate.pairing, duplicate.rest.parameters, Random(1)));
  EXPECT_THAT(problem.landmarks, SizeIs(1));
  EXPECT_NEAR(objective(problem, duplicate.rest.parameters), before - 7.0, 0.1);
}

TEST(Perturb, RestoresEverythingIfTheObjectiveDoesNotFall) {
  Duplicate duplicate;
  duplicate.rest.landmarks.pop_back();
  LandmarkProblem problem = duplicate.solved();
  const LandmarkProblem before = problem;
  EXPECT_FALSE(perturb(problem, duplicate.pairing, duplicate.rest.parameters, Random(1)));
  ASSERT_THAT(problem.landmarks, SizeIs(1));
  EXPECT_EQ(problem.landmarks[0].mean_m, before.landmarks[0].mean_m);
  EXPECT_EQ(problem.poses, before.poses);
  EXPECT_EQ(problem.cost, before.cost);
  EXPECT_TRUE(problem.readings[0].isPaired());
}

TEST(Perturb, IsFixedByItsRandomNumbers) {
  Duplicate duplicate;
  duplicate.rest.parameters.perturbation.removal_share = 0.0;
  duplicate.rest.parameters.perturbation.min_gain = 0.0;
  LandmarkProblem first = duplicate.solved();
  LandmarkProblem second = duplicate.solved();
  for (std::uint64_t attempt = 0; attempt < 3; ++attempt) {
    const auto& parameters = duplicate.rest.parameters;
    EXPECT_EQ(perturb(first, duplicate.pairing, parameters, Random(5, attempt)),
              perturb(second, duplicate.pairing, parameters, Random(5, attempt)));
  }
  EXPECT_EQ(first.poses, second.poses);
  EXPECT_EQ(first.cost, second.cost);
}

TEST(Perturb, NeverRaisesTheObjective) {
  const Duplicate duplicate;
  LandmarkProblem problem = duplicate.solved();
  double before = objective(problem, duplicate.rest.parameters);
  for (std::uint64_t attempt = 0; attempt < 10; ++attempt) {
    perturb(problem, duplicate.pairing, duplicate.rest.parameters, Random(2, attempt));
    const double after = objective(problem, duplicate.rest.parameters);
    EXPECT_LE(after, before);
    before = after;
  }
}

}  // namespace
}  // namespace ram_slam
