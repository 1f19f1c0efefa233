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

TEST(ClockGuard, ItsFirstStampIsLaterThanNone) {
  ClockGuard clock;
  EXPECT_EQ(clock.newest_ns(), 0);
  EXPECT_EQ(clock.check(0), StampOrder::kNotLater) << "0 means that there is no stamp";
  EXPECT_EQ(clock.check(1), StampOrder::kLater);
}

TEST(ClockGuard, AClockThatIsSetBackTwiceIsFollowedTwice) {
  ClockGuard clock;
  clock.check(100 * kSecond);
  EXPECT_EQ(clock.check(50 * kSecond), StampOrder::kSetBack);
  EXPECT_EQ(clock.check(51 * kSecond), StampOrder::kLater);
  EXPECT_EQ(clock.check(kSecond), StampOrder::kSetBack);
  EXPECT_EQ(clock.check(kSecond), StampOrder::kNotLater);
}

TEST(ClockGuard, AJumpForwardIsTakenAsItComes) {
  ClockGuard clock;
  clock.check(kSecond);
  EXPECT_EQ(clock.check(1'000'000 * kSecond), StampOrder::kLater);
  EXPECT_EQ(clock.check(2 * kSecond), StampOrder::kSetBack);
}

}  // namespace
}  // namespace ram_slam
