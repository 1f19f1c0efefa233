// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/random.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace ramscout_sim {
namespace {

TEST(Random, DependsOnSeedPurposeAndIndexAlone) {
  EXPECT_EQ(Random(1, Stream::kSlip, 2).bits(), Random(1, Stream::kSlip, 2).bits());
  std::set<std::uint64_t> firsts;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (std::uint64_t index = 0; index < 10; ++index) {
      firsts.insert(Random(seed, Stream::kSlip, index).bits());
      firsts.insert(Random(seed, Stream::kRange, index).bits());
    }
  }
  EXPECT_EQ(firsts.size(), 200U);
}

TEST(Random, UniformNumbersFillTheirIntervalEvenly) {
  Random random(3, Stream::kBuilding);
  constexpr int kCount = 100000;
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double number = random.uniform(2.0, 5.0);
    ASSERT_GE(number, 2.0);
    ASSERT_LT(number, 5.0);
    sum += number;
  }
  // Five standard deviations of the mean of numbers whose own is 3 / sqrt(12).
  EXPECT_NEAR(sum / kCount, 3.5, 5.0 * 3.0 / std::sqrt(12.0 * kCount));
}

TEST(Random, GaussiansHaveMeanZeroAndVarianceOne) {
  Random random(4, Stream::kSlip);
  constexpr int kCount = 100000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double number = random.gaussian();
    ASSERT_TRUE(std::isfinite(number));
    sum += number;
    squares += number * number;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 5.0 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1.0, 5.0 * std::sqrt(2.0 / kCount));
}

}  // namespace
}  // namespace ramscout_sim
