// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "ramscout_sim/random.hpp"

namespace ramscout_sim {
namespace {

using Block = std::array<std::uint32_t, 4>;

double normalDistribution(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// Largest distance between the numbers' distribution and the normal one (Kolmogorov-Smirnov).
double distanceFromNormal(std::vector<float> numbers) {
  std::sort(numbers.begin(), numbers.end());
  const double n = static_cast<double>(numbers.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double share = normalDistribution(numbers[i]);
    largest = std::max(
        {largest, share - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - share});
  }
  return largest;
}

double correlation(const std::vector<float>& a, const std::vector<float>& b, std::size_t shift) {
  double sum = 0.0;
  const std::size_t count = std::min(a.size(), b.size()) - shift;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(a[i]) * b[i + shift];
  return sum / static_cast<double>(count);
}

// Random123, kat_vectors of its distribution.
TEST(Philox, GivesItsAuthorsKnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Gaussians, AreNormal) {
  constexpr std::size_t kCount = 1'000'000;
  const std::vector<float> numbers = gaussians(Random(1, Stream::kRange), kCount);
  // 1.63 / sqrt(n) is passed by 99 of 100 samples.
  EXPECT_LT(distanceFromNormal(numbers), 1.63 / std::sqrt(kCount));
  double sum = 0.0;
  double squares = 0.0;
  double fourths = 0.0;
  for (const double x : numbers) {
    sum += x;
    squares += x * x;
    fourths += x * x * x * x;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 3.0 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1.0, 3.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourths / kCount, 3.0, 3.0 * std::sqrt(96.0 / kCount));
}

TEST(Gaussians, HaveTheTailsOfTheNormalDistribution) {
  constexpr std::size_t kCount = 4'000'000;
  const std::vector<float> numbers = gaussians(Random(2, Stream::kRange), kCount);
  for (const float bound : {-4.5F, -3.0F, 3.0F, 4.5F}) {
    const double share = normalDistribution(-std::abs(bound));
    const double expected = share * kCount;
    const auto beyond = std::count_if(numbers.begin(), numbers.end(), [bound](float x) {
      return bound < 0.0F ? x < bound : x > bound;
    });
    EXPECT_NEAR(static_cast<double>(beyond), expected, 4.0 * std::sqrt(expected)) << bound;
  }
}

TEST(Gaussians, DoNotDependOnEachOther) {
  constexpr std::size_t kCount = 400'000;
  const std::vector<float> numbers = gaussians(Random(1, Stream::kRange, 7), kCount);
  const double bound = 4.0 / std::sqrt(kCount);
  // Neighbours, the four numbers of a block, the same place in the next block.
  for (const std::size_t shift : {1U, 2U, 63U, 64U, 128U, 192U, 256U, 1081U})
    EXPECT_LT(std::abs(correlation(numbers, numbers, shift)), bound) << shift;
  for (const Random& other :
       {Random(1, Stream::kRange, 8), Random(2, Stream::kRange, 7), Random(1, Stream::kDropout, 7)})
    EXPECT_LT(std::abs(correlation(numbers, gaussians(other, kCount), 0)), bound);
}

TEST(Gaussians, DependOnKeyAndPlaceAlone) {
  const Random key(5, Stream::kRange, 9);
  const std::vector<float> many = gaussians(key, 5000);
  for (const std::size_t count : {0U, 1U, 255U, 256U, 257U, 1081U}) {
    const std::vector<float> few = gaussians(key, count);
    ASSERT_EQ(few.size(), count);
    EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin())) << count;
  }
}

}  // namespace
}  // namespace ramscout_sim
