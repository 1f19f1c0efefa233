// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/drop_counter.hpp"

#include <set>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

TEST(DropCounter, CountsByReasonWithFirstAndLastStamp) {
  DropCounter drops;
  drops.add(DropReason::kNoOdometry, 100, "scan");
  drops.add(DropReason::kNotLater, 200, "odometry");
  drops.add(DropReason::kNoOdometry, 300, "another scan");
  const std::vector<Drops> all = drops.all();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].reason, DropReason::kNotLater);  // in the order of the enumeration
  EXPECT_EQ(all[1].count, 2u);
  EXPECT_EQ(all[1].first_ns, 100);
  EXPECT_EQ(all[1].last_ns, 300);
  EXPECT_EQ(all[1].detail, "another scan");
  EXPECT_EQ(drops.total(), 3u);
  EXPECT_EQ(drops.newest().reason, DropReason::kNoOdometry);
}

TEST(DropCounter, StartsEmpty) {
  const DropCounter drops;
  EXPECT_TRUE(drops.all().empty());
  EXPECT_EQ(drops.total(), 0u);
  EXPECT_THROW(drops.newest(), std::out_of_range);
}

TEST(DropReason, EachHasATextOfItsOwnWithoutNumbers) {
  std::set<std::string> texts;
  for (int i = 0; i <= static_cast<int>(DropReason::kPaused); ++i) {
    const std::string text = toText(static_cast<DropReason>(i));
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text.find_first_of("0123456789"), std::string::npos) << text;
    texts.insert(text);
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(DropReason::kPaused) + 1);
}

TEST(DropCounter, AddsWhatAnotherOneHasCounted) {
  DropCounter all;
  all.add(DropReason::kPaused, 20, "mine");
  DropCounter other;
  other.add(DropReason::kPaused, 10, "theirs");
  other.add(DropReason::kLost, 30);
  all.add(other);
  EXPECT_EQ(all.total(), 3U);
  EXPECT_EQ(all.newest().reason, DropReason::kLost);
  EXPECT_EQ(all.all().front().first_ns, 10);
  EXPECT_EQ(all.all().front().last_ns, 20);
  EXPECT_EQ(all.all().front().detail, "mine");
}

}  // namespace
}  // namespace ram_slam
