// SPDX-License-Identifier: BSD-3-Clause
// What summary.json states about a run is also tested by system_test/live_equals_offline.test.
#include "ramscout_bringup/run_report.hpp"

#include <gtest/gtest.h>

namespace ramscout_bringup {
namespace {

using ram_slam::DropCounter;
using ram_slam::DropReason;

TEST(DropsAsJson, StateReasonCountAndStampsOfEach) {
  DropCounter drops;
  drops.add(DropReason::kNoPose, 5'500'000'000, "too early");
  drops.add(DropReason::kNoOdometry, 1'000'000'000, "none at all");
  drops.add(DropReason::kNoPose, 7'250'000'000, "too late");
  const auto json = toJson(drops);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0]["reason"], toText(DropReason::kNoOdometry));
  EXPECT_EQ(json[0]["count"], 1);
  EXPECT_EQ(json[1]["reason"], toText(DropReason::kNoPose));
  EXPECT_EQ(json[1]["count"], 2);
  EXPECT_DOUBLE_EQ(json[1]["first_s"].get<double>(), 5.5);
  EXPECT_DOUBLE_EQ(json[1]["last_s"].get<double>(), 7.25);
  EXPECT_EQ(json[1]["last_detail"], "too late");
}

TEST(DropsAsJson, OfNothingAreAnEmptyList) {
  EXPECT_EQ(toJson(DropCounter()).dump(), "[]");
}

TEST(DropsAsJson, HaveNoStampsInTheirKeys) {
  DropCounter early;
  DropCounter late;
  early.add(DropReason::kQueueFull, 1);
  late.add(DropReason::kQueueFull, 999'000'000'000);
  const auto a = toJson(early)[0];
  const auto b = toJson(late)[0];
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [key, value] : a.items()) EXPECT_TRUE(b.contains(key)) << key;
}

TEST(LossRecord, StatesWhyAndFromWhenToWhen) {
  LossRecord losses;
  EXPECT_EQ(losses.toJson().dump(), "[]");
  losses.add(1'000'000'000, false, "tracking");
  losses.add(2'000'000'000, true, "carried");
  losses.add(3'000'000'000, true, "another reason");
  losses.add(4'000'000'000, false, "tracking");
  losses.add(5'000'000'000, true, "the map contradicts");
  ASSERT_EQ(losses.count(), 2U);
  const auto json = losses.toJson();
  EXPECT_EQ(json[0]["reason"], "carried");
  EXPECT_DOUBLE_EQ(json[0]["from_s"].get<double>(), 2.0);
  EXPECT_DOUBLE_EQ(json[0]["to_s"].get<double>(), 4.0);
  EXPECT_EQ(json[1]["reason"], "the map contradicts");
  EXPECT_TRUE(json[1]["to_s"].is_null()) << "it is not found again";
}

}  // namespace
}  // namespace ramscout_bringup
