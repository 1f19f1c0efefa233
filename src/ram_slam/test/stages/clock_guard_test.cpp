// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/clock_guard.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(ClockGuard, TakesIncreasingStampsAsTheyCome) {
  ClockGuard clock;
  EXPECT_EQ(clock.check(5 * kSecond), StampOrder::kLater);
  EXPECT_EQ(clock.check(5 * kSecond + 1), StampOrder::kLater);
  EXPECT_EQ(clock.newest_ns(), 5 * kSecond + 1);
}

TEST(ClockGuard, RepetitionsAndSmallStepsBackAreNotLaterAndChangeNothing) {
  ClockGuard clock;
  clock.check(5 * kSecond);
  EXPECT_EQ(clock.check(5 * kSecond), StampOrder::kNotLater);
  EXPECT_EQ(clock.check(4 * kSecond), StampOrder::kNotLater);  // one second exactly
  EXPECT_EQ(clock.newest_ns(), 5 * kSecond);
}

TEST(ClockGuard, MoreThanOneSecondBackMeansThatTheClockWasSetBack) {
  ClockGuard clock;
  clock.check(5 * kSecond);
  EXPECT_EQ(clock.check(4 * kSecond - 1), StampOrder::kSetBack);
  EXPECT_EQ(clock.newest_ns(), 4 * kSecond - 1);
  EXPECT_EQ(clock.check(4 * kSecond), StampOrder::kLater);
}

}  // namespace
}  // namespace ram_slam
