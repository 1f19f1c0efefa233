// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/input_guard.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Messages that are their own stamps [ms], through a guard.
class InputGuardTest : public testing::Test {
protected:
  void add(std::int64_t stamp_ms, const std::string& source = "") {
    take(guard_.add(stamp_ms * 1'000'000, stamp_ms, drops_, source));
  }
  void addEvery(std::int64_t step_ms, std::int64_t from_ms, std::int64_t to_ms) {
    for (std::int64_t stamp_ms = from_ms; stamp_ms < to_ms; stamp_ms += step_ms) add(stamp_ms);
  }
  void take(PassedMessages<std::int64_t> passed) {
    set_back_count_ += passed.is_set_back ? 1 : 0;
    passed_.insert(passed_.end(), passed.messages.begin(), passed.messages.end());
  }
  std::vector<std::int64_t> takePassed() { return std::exchange(passed_, {}); }
  std::string newestDrop() const { return drops_.newest().detail; }

  InputGuard<std::int64_t> guard_;
  DropCounter drops_;
  std::vector<std::int64_t> passed_;
  int set_back_count_ = 0;
};

using Stamps = std::vector<std::int64_t>;

TEST_F(InputGuardTest, StampsInOrderAndALittleOutOfOrderPassAtOnce) {
  for (const std::int64_t stamp_ms : {5000, 5100, 5050, 5050, 5200, 4300}) add(stamp_ms);
  EXPECT_EQ(passed_, (Stamps{5000, 5100, 5050, 5050, 5200, 4300}));
  EXPECT_EQ(drops_.total(), 0u);
}

TEST_F(InputGuardTest, OneScanStampedFiveSecondsBackIsDroppedAndNothingElseChanges) {
  for (const std::int64_t stamp_ms : {9000, 9100, 4200, 9300, 9400}) add(stamp_ms);
  EXPECT_EQ(passed_, (Stamps{9000, 9100, 9300, 9400}));
  EXPECT_EQ(set_back_count_, 0);
  EXPECT_EQ(drops_.total(), 1u);
  EXPECT_EQ(drops_.newest().reason, DropReason::kOtherClock);
  EXPECT_THAT(newestDrop(), HasSubstr("4.900 s older than the others; check"));
}

TEST_F(InputGuardTest, OneScanStampedAMillionSecondsAheadIsDroppedAndNothingElseChanges) {
  for (const std::int64_t stamp_ms : {9000, 9100, 1'000'009'200, 9300, 9400}) add(stamp_ms);
  EXPECT_EQ(passed_, (Stamps{9000, 9100, 9300, 9400}));
  EXPECT_EQ(set_back_count_, 0);
  EXPECT_THAT(newestDrop(), HasSubstr("newer than the others"));
}

TEST_F(InputGuardTest, TwoPublishersWhoseClocksAreApartNeverSetTheClockBack) {
  for (const std::int64_t apart_ms : {-5000, 5000}) {
    guard_ = {};
    addEvery(100, 20'000, 20'500);
    takePassed();
    for (int i = 0; i < 300; ++i) {
      add(20'500 + 100 * i);
      for (int of_other = 0; of_other < 4; ++of_other)  // four times as many
        if (apart_ms < 0) add(20'500 + 100 * i + 25 * of_other + apart_ms);
      if (apart_ms > 0) add(20'500 + 100 * i + apart_ms);
    }
    EXPECT_EQ(set_back_count_, 0);
    EXPECT_EQ(takePassed().size(), 300u);
  }
}

TEST_F(InputGuardTest, ASetBackClockIsFollowedAfterASecondAndNoMessageOfItIsLost) {
  addEvery(100, 60'000, 61'000);
  takePassed();
  addEvery(100, 1000, 2000);
  EXPECT_THAT(takePassed(), IsEmpty());
  add(2000);
  EXPECT_EQ(set_back_count_, 1);
  EXPECT_EQ(takePassed().size(), 11u);
  add(2100);
  EXPECT_EQ(takePassed(), (Stamps{2100}));
  EXPECT_EQ(drops_.total(), 0u);
}

TEST_F(InputGuardTest, AClockThatIsSetBackTwiceIsFollowedTwice) {
  addEvery(100, 60'000, 61'000);
  addEvery(100, 30'000, 32'000);
  addEvery(100, 1000, 3000);
  EXPECT_EQ(set_back_count_, 2);
  EXPECT_EQ(passed_.size(), 50u);
}

TEST_F(InputGuardTest, AfterAPauseTheFirstMessagePassesTogetherWithTheSecond) {
  addEvery(100, 1000, 1500);
  takePassed();
  add(100'000);
  EXPECT_THAT(takePassed(), IsEmpty());
  add(100'100);
  EXPECT_EQ(takePassed(), (Stamps{100'000, 100'100}));
  EXPECT_EQ(set_back_count_, 0);
}

TEST_F(InputGuardTest, ASlowSensorsMessagesPassAtOnceOnceItsIntervalIsKnown) {
  addEvery(4000, 4000, 12'001);
  EXPECT_EQ(passed_, (Stamps{4000, 8000, 12'000}));
  add(16'000);
  EXPECT_EQ(passed_.back(), 16'000);
}

TEST_F(InputGuardTest, ADetectorThatWasStoppedForThreeSecondsIsLateAndSetsNothingBack) {
  add(10'000, "/corners");
  add(10'000, "/edges");
  for (int i = 1; i <= 30; ++i) add(10'000 + 100 * i, "/corners");
  takePassed();
  for (int i = 1; i <= 30; ++i) add(10'000 + 100 * i, "/edges");  // what waited, at once
  EXPECT_EQ(set_back_count_, 0);
  EXPECT_EQ(takePassed().size(), 11u) << "the newest second of it is of use";
  EXPECT_EQ(drops_.total(), 19u);
}

TEST_F(InputGuardTest, BothDetectorsFollowAClockThatWasSetBack) {
  for (int i = 0; i < 20; ++i) {
    add(50'000 + 100 * i, "/corners");
    add(50'000 + 100 * i, "/edges");
  }
  takePassed();
  for (int i = 0; i < 20; ++i) {
    add(1000 + 100 * i, "/edges");
    add(1000 + 100 * i, "/corners");
  }
  EXPECT_EQ(set_back_count_, 1);
  EXPECT_EQ(takePassed().size(), 40u);
  EXPECT_EQ(drops_.total(), 0u);
}

TEST_F(InputGuardTest, AFloodOfOneOldStampIsBoundedAndSetsNothingBack) {
  add(10'000);
  for (int i = 0; i < 10'000; ++i) add(1000);
  EXPECT_EQ(set_back_count_, 0);
  EXPECT_GE(drops_.total(), 8000u);
}

TEST_F(InputGuardTest, TheEndOfARecordingGivesWhatIsAhead) {
  add(1000);
  add(9000);
  take(guard_.finish(drops_));
  EXPECT_EQ(passed_, (Stamps{1000, 9000}));
  add(2000);
  take(guard_.finish(drops_));
  EXPECT_EQ(passed_, (Stamps{1000, 9000}));
  EXPECT_EQ(drops_.total(), 1u);
}

}  // namespace
}  // namespace ram_slam
