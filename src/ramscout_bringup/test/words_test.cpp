// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/words.hpp"

#include <cmath>
#include <optional>

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

/// The stamp of a text; nothing if it is none.
std::optional<std::int64_t> stampOf(const std::string& text) {
  Words words(text);
  const std::int64_t stamp_ns = words.stampNs();
  return words.good() ? std::optional(stamp_ns) : std::nullopt;
}

TEST(Words, AreSeparatedByBlanksAndTabsOfAnyNumber) {
  Words words("  one\ttwo \t three");
  EXPECT_EQ(words.next(), "one");
  EXPECT_EQ(words.next(), "two");
  EXPECT_EQ(words.next(), "three");
  EXPECT_TRUE(words.good());
  EXPECT_EQ(words.next(), "");
  EXPECT_FALSE(words.good());
}

TEST(Words, ANumberIsAWholeWord) {
  for (const char* text : {"1.5x", "x", "", "1,5", "0x10"}) {
    Words words(text);
    words.number<double>();
    EXPECT_FALSE(words.good()) << text;
  }
  Words integers("12 1.5");
  EXPECT_EQ(integers.number<int>(), 12);
  EXPECT_TRUE(integers.good());
  integers.number<int>();
  EXPECT_FALSE(integers.good());
}

TEST(Words, AFailureSticksThoughLaterWordsAreRight) {
  Words words("x 2 3");
  words.number<int>();
  EXPECT_EQ(words.number<int>(), 2);
  EXPECT_EQ(words.number<int>(), 3);
  EXPECT_FALSE(words.good());
}

TEST(Words, StampsAreExactToTheNanosecond) {
  EXPECT_EQ(stampOf("1700000000.123456789"), 1700000000123456789);
  EXPECT_EQ(stampOf("12"), 12000000000);
  EXPECT_EQ(stampOf("0.000000001"), 1);
  EXPECT_EQ(stampOf(".5"), 500000000);
  EXPECT_EQ(stampOf("7."), 7000000000);
  EXPECT_EQ(stampOf("-1.5"), -1500000000);
}

TEST(Words, DigitsBelowTheNanosecondAreCutOff) {
  EXPECT_EQ(stampOf("1.0000000019"), 1000000001);
  EXPECT_EQ(stampOf("1e-12"), 0);
}

TEST(Words, StampsMayHaveAnExponent) {
  EXPECT_EQ(stampOf("1.7000000001234e+09"), 1700000000123400000);
  EXPECT_EQ(stampOf("1.7E9"), 1700000000000000000);
  EXPECT_EQ(stampOf("15e-1"), 1500000000);
}

TEST(Words, WhatIsNoStampIsAFailure) {
  for (const char* text : {"", "x", "1.2.3", "1e", "e5", "nan", "1e30", "99999999999999999999"})
    EXPECT_FALSE(stampOf(text)) << text;
}

TEST(Words, APoseHasThreeFiniteNumbersAndAWrappedYaw) {
  Words good("1 -2 7.0");
  const ram_slam::Pose2 pose = good.pose();
  EXPECT_TRUE(good.good());
  EXPECT_EQ(pose.y_m, -2.0);
  EXPECT_NEAR(pose.yaw_rad, 7.0 - 2.0 * M_PI, 1e-12);
  for (const char* text : {"1 2", "1 inf 0", "nan 0 0", "1 2 x"}) {
    Words words(text);
    words.pose();
    EXPECT_FALSE(words.good()) << text;
  }
}

TEST(Words, ReadingsAreAsManyAsWereAnnounced) {
  Words enough("1 2.5 3 rest");
  EXPECT_THAT(enough.readings(3), testing::ElementsAre(1.0F, 2.5F, 3.0F));
  EXPECT_TRUE(enough.good());
  EXPECT_EQ(enough.next(), "rest");
  Words too_few("1 2");
  too_few.readings(3);
  EXPECT_FALSE(too_few.good());
}

TEST(Words, ACountThatNoScanHasAllocatesNothing) {
  Words words("1 2 3");
  EXPECT_TRUE(words.readings(static_cast<std::size_t>(-1)).empty());
  EXPECT_FALSE(words.good());
}

}  // namespace
}  // namespace ramscout_bringup
