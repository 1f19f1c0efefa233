// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/stamp_review.hpp"

#include <algorithm>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kSecondNs = 1'000'000'000;

/// One stamp every 100 ms.
std::vector<std::int64_t> drive(std::int64_t from_s, std::size_t count) {
  std::vector<std::int64_t> stamps_ns;
  for (std::size_t i = 0; i < count; ++i)
    stamps_ns.push_back(from_s * kSecondNs + static_cast<std::int64_t>(i) * kSecondNs / 10);
  return stamps_ns;
}

void append(std::vector<std::int64_t>& all, const std::vector<std::int64_t>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

TEST(StampReview, RegularStampsHaveAPeriodAndNothingElse) {
  const StampReview review = reviewStamps(drive(100, 50));
  EXPECT_THAT(review.stray, IsEmpty());
  EXPECT_THAT(review.reset, IsEmpty());
  EXPECT_NEAR(review.period_s, 0.1, 1e-9);
}

TEST(StampReview, SingleStampFarBackOrFarAheadIsStray) {
  for (const std::int64_t offset_s : {-5, 1'000'000}) {
    std::vector<std::int64_t> stamps_ns = drive(100, 100);
    stamps_ns[40] += offset_s * kSecondNs;
    const StampReview review = reviewStamps(stamps_ns);
    EXPECT_THAT(review.stray, ElementsAre(40U));
    EXPECT_THAT(review.reset, IsEmpty());
  }
}

TEST(StampReview, ArrivalOutOfOrderByLessThanASecondIsNothing) {
  std::vector<std::int64_t> stamps_ns = drive(100, 100);
  std::swap(stamps_ns[40], stamps_ns[45]);
  const StampReview review = reviewStamps(stamps_ns);
  EXPECT_THAT(review.stray, IsEmpty());
  EXPECT_THAT(review.reset, IsEmpty());
}

TEST(StampReview, ClockThatWasSetBackBeginsAnotherDrive) {
  for (const std::size_t second : {30U, 200U}) {  // shorter and longer than the first one
    std::vector<std::int64_t> stamps_ns = drive(100, 100);
    append(stamps_ns, drive(100, second));
    EXPECT_THAT(reviewStamps(stamps_ns).reset, ElementsAre(100U)) << second;
  }
}

TEST(StampReview, MessageThatWasWrittenLateButFillsAHoleIsNothing) {
  std::vector<std::int64_t> stamps_ns = drive(100, 100);
  std::rotate(stamps_ns.begin() + 20, stamps_ns.begin() + 21, stamps_ns.begin() + 80);
  EXPECT_THAT(reviewStamps(stamps_ns).stray, IsEmpty());
}

TEST(StampReview, FileInNoOrderOfTimeIsOneDrive) {
  std::vector<std::int64_t> stamps_ns = drive(100, 101);
  std::vector<std::int64_t> shuffled_ns;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i)
    shuffled_ns.push_back(stamps_ns[i * 37 % stamps_ns.size()]);
  const StampReview review = reviewStamps(shuffled_ns);
  EXPECT_THAT(review.reset, IsEmpty());
  EXPECT_THAT(review.stray, IsEmpty());
}

TEST(StampReview, LongPauseIsAGapAndNoReset) {
  std::vector<std::int64_t> stamps_ns = drive(100, 20);
  append(stamps_ns, drive(4000, 20));
  const StampReview review = reviewStamps(stamps_ns);
  EXPECT_THAT(review.stray, IsEmpty());
  EXPECT_NEAR(review.longest_gap_s, 3898.1, 1e-6);
}

TEST(SelectDrive, AsksWhichOfSeveralDrivesIsWanted) {
  std::vector<std::int64_t> stamps_ns = drive(100, 40);
  append(stamps_ns, drive(50, 60));
  try {
    selectDrive(stamps_ns, "/scan", std::nullopt);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/scan was set back 1 times, first after message 40"));
    EXPECT_THAT(error.what(), HasSubstr("from 103.900 s to 50.000 s"));
  }
  EXPECT_THAT(selectDrive(stamps_ns, "/scan", 1).order, SizeIs(40U));
  EXPECT_EQ(selectDrive(stamps_ns, "/scan", 2).order.front(), 40U);
  EXPECT_THROW(selectDrive(stamps_ns, "/scan", 3), std::runtime_error);
}

TEST(SelectDrive, OrdersByStampAndCountsStrayOnes) {
  std::vector<std::int64_t> stamps_ns = drive(100, 30);
  std::swap(stamps_ns[3], stamps_ns[4]);
  stamps_ns[20] = 7 * kSecondNs;
  const Drive selected = selectDrive(stamps_ns, "/scan", std::nullopt);
  EXPECT_EQ(selected.stray_count, 1U);
  EXPECT_THAT(selected.order, SizeIs(29U));
  EXPECT_EQ(selected.order[3], 4U);
  EXPECT_THAT(selected.notes, ElementsAre(HasSubstr("left out 1 messages of /scan")));
}

TEST(SelectScans, KeepsTheWishedTimeAndRate) {
  const std::vector<std::int64_t> stamps_ns = drive(100, 100);
  const Drive all = selectDrive(stamps_ns, "/scan", std::nullopt);
  RecordingOptions options;
  options.start_s = 2.0;
  options.duration_s = 3.0;
  EXPECT_THAT(selectScans(all, stamps_ns, options), SizeIs(31U));
  options.max_rate_hz = 5.0;
  EXPECT_THAT(selectScans(all, stamps_ns, options), SizeIs(16U));
  options.start_s = 20.0;
  EXPECT_THROW(selectScans(all, stamps_ns, options), std::runtime_error);
}

}  // namespace
}  // namespace ramscout_bringup
