// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/measurement.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(RangesOf, HaveLeastMeanAndGreatestOfEachInterval) {
  const Measurement measurement{
      "speed", "m/s", "", {{0, 4.0}, {1 * kSecond, 2.0}, {2 * kSecond, 3.0}, {9 * kSecond, -1.0}}};
  const auto ranges = rangesOf(measurement, 0, 10 * kSecond, 2);
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_DOUBLE_EQ(ranges[0].middle_s, 2.5);
  EXPECT_DOUBLE_EQ(ranges[0].least, 2.0);
  EXPECT_DOUBLE_EQ(ranges[0].mean, 3.0);
  EXPECT_DOUBLE_EQ(ranges[0].greatest, 4.0);
  EXPECT_DOUBLE_EQ(ranges[1].middle_s, 7.5);
  EXPECT_DOUBLE_EQ(ranges[1].mean, -1.0);
}

TEST(RangesOf, LeaveOutEmptyIntervalsSamplesOutsideAndValuesThatAreNotFinite) {
  const Measurement measurement{"speed",
                                "m/s",
                                "",
                                {{-1, 9.0},
                                 {11 * kSecond, 9.0},
                                 {kSecond, std::nan("")},
                                 {kSecond, std::numeric_limits<double>::infinity()},
                                 {10 * kSecond, 1.0}}};
  const auto ranges = rangesOf(measurement, 0, 10 * kSecond, 5);
  ASSERT_EQ(ranges.size(), 1U);
  EXPECT_DOUBLE_EQ(ranges[0].middle_s, 9.0) << "the end belongs to the last interval";
  EXPECT_DOUBLE_EQ(ranges[0].greatest, 1.0);
}

TEST(RangesOf, NoTimeAtAllAreEmpty) {
  EXPECT_TRUE(rangesOf({"a", "", "", {{0, 1.0}}}, 0, 0, 10).empty());
  EXPECT_TRUE(rangesOf({"a", "", "", {{0, 1.0}}}, 0, kSecond, 0).empty());
}

TEST(RateCounter, CountsWholeSecondsOnly) {
  RateCounter counter;
  for (int i = 5; i < 38; ++i) counter.add(i * kSecond / 10);  // 0.5 s to 3.7 s, 10 per second
  const auto samples = counter.perSecond();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].stamp_ns, 3 * kSecond / 2);
  EXPECT_DOUBLE_EQ(samples[0].value, 10.0);
  EXPECT_DOUBLE_EQ(samples[1].value, 10.0);
}

TEST(RateCounter, ASilenceIsZeroFromItsBeginningToItsEnd) {
  RateCounter counter;
  for (const std::int64_t second : {0, 1, 100, 101, 103, 104}) counter.add(second * kSecond);
  std::vector<std::pair<std::int64_t, double>> rates;
  for (const Sample& sample : counter.perSecond())
    rates.emplace_back(sample.stamp_ns / kSecond, sample.value);
  const std::vector<std::pair<std::int64_t, double>> expected = {
      {1, 1.0}, {2, 0.0}, {99, 0.0}, {100, 1.0}, {101, 1.0}, {102, 0.0}, {103, 1.0}};
  EXPECT_EQ(rates, expected);
}

TEST(RateCounter, OfLessThanAWholeSecondHasNothing) {
  RateCounter counter;
  counter.add(kSecond);
  counter.add(2 * kSecond);
  EXPECT_TRUE(counter.perSecond().empty());
}

}  // namespace
}  // namespace ramscout_bringup
