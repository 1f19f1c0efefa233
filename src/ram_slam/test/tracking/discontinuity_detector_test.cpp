// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/discontinuity_detector.hpp"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>

#include "rooms.hpp"

namespace ram_slam {
namespace {

constexpr std::int64_t kPeriodNs = 100'000'000;
using Finding = DiscontinuityDetector::Finding;

/// A robot that stands, with a view every tenth of a second.
class Discontinuities : public testing::Test {
protected:
  TrackedView at(const Pose2& map_from_base) {
    now_ns_ += kPeriodNs;
    return {now_ns_, {}, viewIn(room_, map_from_base)};
  }

  void fill() {
    for (int i = 0; i < 12; ++i) detector_.add(at(here_));
  }

  const Walls room_ = oddRoom();
  const Pose2 here_{3.0, 1.5, 0.0};
  const Pose2 elsewhere_{11.0, 1.8, 3.0};
  std::int64_t now_ns_ = 1'000'000'000;
  DiscontinuityDetector detector_{0.2, {}};
};

TEST_F(Discontinuities, FindNothingWhileViewsAgree) {
  fill();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(detector_.compare(at(here_)), Finding::kNothing);
  EXPECT_FALSE(detector_.suspicious(now_ns_));
}

TEST_F(Discontinuities, FindARobotThatWasCarriedAwayAfterTwoTenthsOfASecond) {
  fill();
  EXPECT_EQ(detector_.compare(at(elsewhere_)), Finding::kNothing);
  EXPECT_EQ(detector_.compare(at(elsewhere_)), Finding::kNothing);
  EXPECT_EQ(detector_.compare(at(elsewhere_)), Finding::kCarriedAway);
}

TEST_F(Discontinuities, ForgetAScanThatWasPlacedWrongly) {
  fill();
  EXPECT_EQ(detector_.compare(at(elsewhere_)), Finding::kNothing);
  EXPECT_EQ(detector_.compare(at(here_)), Finding::kNothing);
  EXPECT_EQ(detector_.compare(at(elsewhere_)), Finding::kNothing);
  EXPECT_EQ(detector_.compare(at(elsewhere_)), Finding::kNothing);
}

TEST_F(Discontinuities, AreSuspiciousBelowTheThresholdAndReportItOnce) {
  detector_ = DiscontinuityDetector(1.0, {});
  fill();
  std::vector<Finding> findings;
  for (int i = 0; i < 6; ++i) findings.push_back(detector_.compare(at(elsewhere_)));
  const double ratio = *discontinuity(TrackedView{1, {}, viewIn(room_, here_)}, at(elsewhere_));
  ASSERT_GT(ratio, 0.25);
  ASSERT_LT(ratio, 0.5);
  EXPECT_EQ(std::count(findings.begin(), findings.end(), Finding::kSuspicious), 1);
  EXPECT_TRUE(detector_.suspicious(now_ns_));
  EXPECT_FALSE(detector_.suspicious(now_ns_ + 3'000'000'000));
}

TEST_F(Discontinuities, HaveNoReferenceAfterASecondWithoutViews) {
  fill();
  now_ns_ += 1'500'000'000;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(detector_.compare(at(elsewhere_)), Finding::kNothing);
}

TEST_F(Discontinuities, FindNothingWithoutAView) {
  fill();
  EXPECT_EQ(detector_.compare({now_ns_ + kPeriodNs, {}, nullptr}), Finding::kNothing);
}

TEST_F(Discontinuities, KeepViewsOfTheLastSecondAtTheirPeriod) {
  fill();
  EXPECT_EQ(detector_.views().size(), 11U);
  TrackedView soon = at(here_);
  soon.stamp_ns = detector_.views().back().stamp_ns + 50'000'000;
  detector_.add(soon);
  EXPECT_EQ(detector_.views().size(), 11U);
  detector_.clear();
  EXPECT_TRUE(detector_.views().empty());
}

TEST_F(Discontinuities, OfADisturbanceEndWhenTheViewIsAsBefore) {
  DisturbanceDetector disturbance({}, at(here_), now_ns_);
  EXPECT_FALSE(disturbance.isOver(at(elsewhere_)));
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(disturbance.isOver(at(here_)));
  EXPECT_TRUE(disturbance.isOver(at(here_)));
}

TEST_F(Discontinuities, OfADisturbanceNeverEndOnceTheRobotHasMovedOn) {
  DisturbanceDetector disturbance({}, at(here_), now_ns_);
  TrackedView far = at(here_);
  far.local_from_base = {1.1, 0.0, 0.0};
  EXPECT_FALSE(disturbance.isOver(far));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(disturbance.isOver(at(here_)));
}

TEST_F(Discontinuities, WithoutAViewFromBeforeAreNoDisturbance) {
  DisturbanceDetector disturbance({}, std::nullopt, now_ns_);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(disturbance.isOver(at(here_)));
}

}  // namespace
}  // namespace ram_slam
