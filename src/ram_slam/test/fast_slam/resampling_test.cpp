// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

TEST(ResampleLowVariance, KeepsExactCountsWhereTheyAreWhole) {
  std::vector<double> weights(10, 0.0);
  weights[1] = 0.5;
  weights[4] = 0.3;
  weights[9] = 0.2;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    EXPECT_THAT(resampleLowVariance(weights, random), ElementsAre(1, 1, 1, 1, 1, 4, 4, 4, 9, 9));
  }
}

TEST(ResampleLowVariance, KeepsEachParticleFloorOrCeilingOfItsShare) {
  Random random(7);
  for (int run = 0; run < 200; ++run) {
    std::vector<double> weights(50);
    double sum = 0.0;
    for (double& weight : weights) sum += weight = std::exp(2.0 * random.gaussian());
    const std::vector<std::size_t> kept = resampleLowVariance(weights, random);
    ASSERT_EQ(kept.size(), weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double share = 50.0 * weights[i] / sum;
      const double count = static_cast<double>(std::count(kept.begin(), kept.end(), i));
      EXPECT_GE(count, std::floor(share - 1e-9));
      EXPECT_LE(count, std::ceil(share + 1e-9));
    }
  }
}

TEST(ResampleLowVariance, RefusesWeightsThatSayNothing) {
  Random random(1);
  EXPECT_THROW(resampleLowVariance({}, random), std::invalid_argument);
  EXPECT_THROW(resampleLowVariance({0.0, 0.0}, random), std::invalid_argument);
  EXPECT_THROW(resampleLowVariance({1.0, std::nan("")}, random), std::invalid_argument);
}

TEST(NormalisedWeights, SurvivesUnderflowAndLackOfEvidence) {  // fault F128
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  EXPECT_THAT(normalisedWeights({-1e5, -1e5, kNone, -1e5}),
              ElementsAre(1.0 / 3, 1.0 / 3, 0.0, 1.0 / 3));
  EXPECT_THAT(normalisedWeights({kNone, kNone}), Each(0.5));
  EXPECT_THAT(normalisedWeights({0.0, std::nan("")}), Each(0.5));
  EXPECT_TRUE(normalisedWeights({}).empty());
}

TEST(EffectiveCount, IsAllForEqualWeightsAndOneForASingleOne) {
  EXPECT_DOUBLE_EQ(effectiveCount({0.25, 0.25, 0.25, 0.25}), 4.0);
  EXPECT_DOUBLE_EQ(effectiveCount({0.0, 1.0}), 1.0);
}

}  // namespace
}  // namespace ram_slam
