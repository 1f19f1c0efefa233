// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/assignment.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

/// The largest sum by trying everything; `forbidden` is the index of a candidate not to use.
double bestSum(const std::vector<Candidate>& candidates,
               std::size_t first = 0,
               std::size_t forbidden = 1000,
               std::size_t used_rows = 0,
               std::size_t used_columns = 0) {
  double best = 0.0;
  for (std::size_t i = first; i < candidates.size(); ++i) {
    const std::size_t row = std::size_t{1} << candidates[i].row;
    const std::size_t column = std::size_t{1} << candidates[i].column;
    if (i == forbidden || (used_rows & row) != 0 || (used_columns & column) != 0) continue;
    best = std::max(best, candidates[i].score + bestSum(candidates, i + 1, forbidden,
                                                        used_rows | row, used_columns | column));
  }
  return best;
}

TEST(BestAssignment, AgreesWithTryingEverything) {
  Random random(3);
  for (int run = 0; run < 300; ++run) {
    std::vector<Candidate> candidates;
    for (std::size_t row = 0; row < 5; ++row) {
      for (std::size_t column = 0; column < 5; ++column) {
        if (random.uniform() < 0.4) candidates.push_back({row, column, 4.0 * random.gaussian()});
      }
    }
    double sum = 0.0;
    for (const Choice& choice : bestAssignment(candidates)) {
      sum += candidates[choice.candidate].score;
      EXPECT_NEAR(choice.margin, bestSum(candidates) - bestSum(candidates, 0, choice.candidate),
                  1e-9);
    }
    EXPECT_NEAR(sum, bestSum(candidates), 1e-9);
  }
}

TEST(BestAssignment, GivesUpTheBestPairForTheBetterWhole) {
  // Row 0 likes column 0 most, but row 1 has no other choice.
  const std::vector<Choice> choices = bestAssignment({{0, 0, 5.0}, {0, 1, 4.0}, {1, 0, 4.5}});
  ASSERT_EQ(choices.size(), 2U);
  EXPECT_EQ(choices[0].candidate, 2U);
  EXPECT_EQ(choices[1].candidate, 1U);
  EXPECT_DOUBLE_EQ(choices[0].margin, 8.5 - 5.0);
}

}  // namespace
}  // namespace ram_slam
