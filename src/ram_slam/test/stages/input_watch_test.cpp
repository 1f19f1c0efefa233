// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/input_watch.hpp"

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

TEST(InputWatch, BeforeTheFirstMessageNothingHasCome) {
  InputFacts facts;
  InputWatch().report(10.0, facts);
  EXPECT_EQ(facts.age_s, kNever_s);
}

TEST(InputWatch, StatesRateIntervalAndAge) {
  InputWatch watch;
  for (int i = 0; i <= 100; ++i) watch.arrived("/lidar", 0.0, 0.1 * i);
  InputFacts facts;
  watch.report(10.5, facts);
  EXPECT_NEAR(facts.age_s, 0.5, 1e-9);
  EXPECT_NEAR(facts.interval_s, 0.1, 1e-9);
  EXPECT_NEAR(watch.rate_hz(10.5), 10.0, 1e-9);
  EXPECT_EQ(facts.newest_publisher, "/lidar");
  EXPECT_EQ(watch.rate_hz(20.0), 0.0);
}

TEST(InputWatch, OfASlowSensorTheIntervalIsKnownFromTwoMessages) {
  InputWatch watch;
  watch.arrived("/lidar", 0.0, 0.0);
  watch.arrived("/lidar", 0.0, 7.0);
  InputFacts facts;
  watch.report(8.0, facts);
  EXPECT_EQ(facts.interval_s, 7.0);
}

TEST(InputWatch, TheStampNearestToTheClockCounts) {
  InputWatch watch;
  for (const double age_s : {5.0, -0.1, 4.0}) watch.arrived("/lidar", age_s, 0.0);
  InputFacts facts;
  watch.report(0.0, facts);
  EXPECT_EQ(facts.stamp_age_s, -0.1) << "the others waited in a queue";
}

TEST(InputWatch, MessagesThatAreAllRefusedAreRefused) {
  InputWatch watch;
  for (int i = 0; i <= 10; ++i) {
    watch.arrived("/wheels", 0.0, 0.1 * i);
    watch.refused("another frame", 0.1 * i);
  }
  InputFacts facts;
  watch.report(1.0, facts);
  EXPECT_EQ(facts.refusal, "another frame");
  watch.arrived("/wheels", 0.0, 1.1);
  watch.report(1.1, facts);
  EXPECT_EQ(facts.refusal, "");
}

TEST(InputWatch, OneMessageThatIsRefusedIsNone) {
  InputWatch watch;
  for (int i = 0; i <= 10; ++i) watch.arrived("/wheels", 0.0, 0.1 * i);
  watch.refused("not a number", 1.0);
  InputFacts facts;
  watch.report(1.0, facts);
  EXPECT_EQ(facts.refusal, "");
}

TEST(LatencyWatch, StatesMedianAndSlowest) {
  LatencyWatch watch;
  for (int i = 1; i <= 100; ++i) {
    watch.arrived(i, 10.0 * i);
    watch.answered(i, 10.0 * i + 0.001 * i);
  }
  EXPECT_NEAR(watch.percentile_s(0.5), 0.050, 1e-9);
  EXPECT_NEAR(watch.percentile_s(0.99), 0.099, 1e-9);
}

TEST(LatencyWatch, AnAnswerToNothingIsNone) {
  LatencyWatch watch;
  watch.arrived(1, 0.0);
  watch.answered(2, 5.0);
  EXPECT_EQ(watch.percentile_s(0.5), 0.0);
}

}  // namespace
}  // namespace ram_slam
