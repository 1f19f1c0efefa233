// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/association.hpp"

#include <cmath>
#include <map>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr double kVariance_m2 = 1e-4;

LandmarkTree treeOf(const std::vector<Eigen::Vector2d>& places_m) {
  LandmarkTree tree;
  for (LandmarkId id = 0; id < places_m.size(); ++id) {
    tree.set(id, {places_m[id], kVariance_m2 * Eigen::Matrix2d::Identity()});
  }
  return tree;
}

/// Features that may show any of the landmarks, all of them confirmed.
std::vector<Observation> observationsOf(const std::vector<Eigen::Vector2d>& places_m,
                                        std::size_t landmarks) {
  std::vector<Observation> observations;
  for (const Eigen::Vector2d& place_m : places_m) {
    observations.push_back({"pole", {place_m, kVariance_m2 * Eigen::Matrix2d::Identity()}, {}});
    for (LandmarkId id = 0; id < landmarks; ++id)
      observations.back().candidates.push_back({id, true, 0.0});
  }
  return observations;
}

std::map<LandmarkId, int> matchesOf(const Eigen::Vector2d& feature_m, int draws) {
  const std::vector<Eigen::Vector2d> landmarks_m = {{2.0, 0.02}, {2.0, -0.02}};
  std::map<LandmarkId, int> counts;
  for (int i = 0; i < draws; ++i) {
    const Evidence evidence = associate(observationsOf({feature_m}, 2), treeOf(landmarks_m), {},
                                        FastSlamParameters{}, Random(1, i));
    if (evidence.associations[0].outcome == AssociationOutcome::kMatched)
      ++counts[evidence.associations[0].id];
  }
  return counts;
}

TEST(Associate, UndecidedPairsAreDrawnAsOftenAsTheyAreLikely) {
  constexpr int kDraws = 2000;
  // ln(L0 / L1) of a feature 2.5 mm off the middle of landmarks 40 mm apart; S = 2 kVariance_m2.
  const double log_ratio = 2.0 * 0.0025 * 0.02 / (2.0 * kVariance_m2);
  const double wanted = kDraws / (1.0 + std::exp(-log_ratio));
  std::map<LandmarkId, int> counts = matchesOf({2.0, 0.0025}, kDraws);
  EXPECT_NEAR(counts[0], wanted, 4.0 * std::sqrt(0.25 * kDraws));
  EXPECT_GT(counts[0] + counts[1], 0.99 * kDraws);
}

TEST(Associate, WhatWasDrawnWeighsAsMuchAsAllAlternativesTogether) {
  // In the middle between two landmarks: each particle draws one of them, none is the better for
  // it.
  const std::vector<Eigen::Vector2d> landmarks_m = {{2.0, 0.02}, {2.0, -0.02}};
  const double density = 0.05;  // unknown_feature_density
  const double variance_m2 = 2.0 * kVariance_m2;
  const double likelihood = std::exp(-0.5 * 4e-4 / variance_m2) / (2.0 * M_PI * variance_m2);
  const double wanted = std::log(1.0 + 2.0 * likelihood / density);
  FastSlamParameters parameters;
  parameters.draw_jointly = true;
  for (int i = 0; i < 20; ++i) {
    const Evidence evidence = associate(observationsOf({{2.0, 0.0}}, 2), treeOf(landmarks_m), {},
                                        parameters, Random(1, i));
    EXPECT_NEAR(evidence.log_likelihood_ratio, wanted, 1e-9);
  }
}

TEST(Associate, PairsThatFitTogetherAreDrawnTogether) {
  // The first feature lies between both landmarks, the second fits the upper one alone: it gets it
  // only if the first is not drawn without it.
  const std::vector<Eigen::Vector2d> landmarks_m = {{2.0, -0.02}, {2.0, 0.02}};
  const std::vector<Eigen::Vector2d> features_m = {{2.0, 0.001}, {2.0, 0.055}};
  FastSlamParameters parameters;
  parameters.draw_jointly = true;
  parameters.ambiguity_margin = 1e3;  // leaves all to chance
  int both = 0;
  for (int i = 0; i < 100; ++i) {
    const Evidence evidence =
        associate(observationsOf(features_m, 2), treeOf(landmarks_m), {}, parameters, Random(1, i));
    both += evidence.associations[0].outcome == AssociationOutcome::kMatched &&
            evidence.associations[0].id == 0 && evidence.associations[1].id == 1 &&
            evidence.associations[1].outcome == AssociationOutcome::kMatched;
  }
  EXPECT_GE(both, 95);
}

TEST(Associate, SurePairsAreNotLeftToChance) {
  EXPECT_THAT(matchesOf({2.0, 0.02}, 100), testing::ElementsAre(testing::Pair(0, 100)));
}

TEST(Associate, EachLandmarkIsMatchedOnceAndTheOtherFeatureIsNew) {
  const std::vector<Eigen::Vector2d> features_m = {{2.0, 0.0}, {2.0, 0.15}};
  const Evidence evidence = associate(observationsOf(features_m, 1), treeOf({{2.0, 0.01}}), {},
                                      FastSlamParameters{}, Random(1));
  EXPECT_EQ(evidence.associations[0].outcome, AssociationOutcome::kMatched);
  EXPECT_EQ(evidence.associations[1].outcome, AssociationOutcome::kNew);
}

TEST(Associate, OneThingFoundTwiceIsNotTwoLandmarks) {
  const std::vector<Eigen::Vector2d> features_m = {{2.0, 0.0}, {2.0, 0.03}};
  const auto observations = observationsOf(features_m, 1);
  FastSlamParameters parameters;
  EXPECT_EQ(associate(observations, treeOf({{2.0, 0.0}}), {}, parameters, Random(1))
                .associations[1]
                .outcome,
            AssociationOutcome::kIgnored);
  parameters.duplicate_gate = 0.0;  // a detector that never does that
  EXPECT_EQ(associate(observations, treeOf({{2.0, 0.0}}), {}, parameters, Random(1))
                .associations[1]
                .outcome,
            AssociationOutcome::kNew);
}

TEST(AssociateByDistance, BetweenTheTwoDistancesAFeatureIsNeitherMatchedNorNew) {  // fault F127
  const FastSlamParameters parameters;
  const auto outcomeAt = [&parameters](double distance_m) {
    return associateByDistance(observationsOf({{2.0 + distance_m, 0.0}}, 1), treeOf({{2.0, 0.0}}),
                               {}, parameters)
        .associations[0]
        .outcome;
  };
  EXPECT_EQ(outcomeAt(0.99 * parameters.feature_match_distance), AssociationOutcome::kMatched);
  EXPECT_EQ(outcomeAt(1.01 * parameters.feature_match_distance), AssociationOutcome::kIgnored);
  EXPECT_EQ(outcomeAt(0.99 * parameters.minimum_feature_separation), AssociationOutcome::kIgnored);
  EXPECT_EQ(outcomeAt(1.01 * parameters.minimum_feature_separation), AssociationOutcome::kNew);
}

TEST(AssociateCertain, TakesWhatIsCertainAndIgnoresTheRest) {
  // One feature on a landmark that stands alone, one in the middle between two others.
  const std::vector<Eigen::Vector2d> landmarks_m = {{2.0, 0.02}, {2.0, -0.02}, {3.0, 1.0}};
  const Evidence evidence = associateCertain(observationsOf({{2.0, 0.0}, {3.0, 1.005}}, 3),
                                             treeOf(landmarks_m), {}, FastSlamParameters{});
  EXPECT_EQ(evidence.associations[0].outcome, AssociationOutcome::kIgnored);
  EXPECT_EQ(evidence.associations[1].outcome, AssociationOutcome::kMatched);
  EXPECT_TRUE(evidence.hasMatched(2));
  EXPECT_FALSE(evidence.hasMatched(0));
  EXPECT_EQ(evidence.correction_count, 1);
}

TEST(MatchQuality, IsARunningMeanOfSharesAndInnovations) {
  Evidence evidence;
  evidence.associations = {{AssociationOutcome::kMatched, 1}, {AssociationOutcome::kNew, 0}};
  evidence.correction_count = 1;
  evidence.squared_mahalanobis = 6.0;
  MatchQuality quality;
  quality.add(evidence, 0.5);
  EXPECT_EQ(quality.matched_count, 1);
  EXPECT_EQ(quality.new_count, 1);
  EXPECT_DOUBLE_EQ(quality.matched_fraction, 0.75);
  EXPECT_DOUBLE_EQ(quality.normalised_innovation, 2.0) << "half of 1 and half of 6 / 2";
  quality.add({}, 0.5);
  EXPECT_EQ(quality.matched_count, 0);
  EXPECT_DOUBLE_EQ(quality.matched_fraction, 0.75) << "an empty list is no evidence";
}

}  // namespace
}  // namespace ram_slam
