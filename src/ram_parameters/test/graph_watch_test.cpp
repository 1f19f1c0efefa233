// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/graph_watch.hpp"

#include <gmock/gmock.h>

namespace ram_parameters {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr GraphSight kGood{true, true, false, true};
constexpr GraphSight kNoMaster{false, false, false, false};
constexpr GraphSight kForgotten{true, false, false, false};
constexpr GraphSight kNoClock{true, true, true, false};

TEST(GraphWatch, ANodeThatSeesMasterAndClockReportsNothing) {
  GraphWatch watch;
  watch.see(kGood, 1.0);
  EXPECT_THAT(watch.problem(), IsEmpty());
  EXPECT_FALSE(watch.mustEnd());
}

TEST(GraphWatch, WithoutTheMasterANodeGoesOnAndSaysSo) {
  GraphWatch watch;
  for (int i = 0; i < 100; ++i) watch.see(kNoMaster, 1.0);
  EXPECT_THAT(watch.problem(), HasSubstr("start roscore again"));
  EXPECT_FALSE(watch.mustEnd());
  watch.see(kGood, 1.0);
  EXPECT_THAT(watch.problem(), IsEmpty());
}

TEST(GraphWatch, ANodeThatANewMasterDoesNotKnowEnds) {
  GraphWatch watch;
  watch.see(kNoMaster, 1.0);
  watch.see(kForgotten, 1.0);
  EXPECT_FALSE(watch.mustEnd()) << "once may be by chance";
  watch.see(kForgotten, 1.0);
  EXPECT_TRUE(watch.mustEnd());
  EXPECT_THAT(watch.problem(), HasSubstr("it ends"));
}

TEST(GraphWatch, SimulatedTimeWithoutAClockIsReportedAfterTwoSeconds) {
  GraphWatch watch;
  watch.see(kNoClock, 1.0);
  EXPECT_THAT(watch.problem(), IsEmpty());
  watch.see(kNoClock, 1.0);
  EXPECT_THAT(watch.problem(), HasSubstr("nothing comes on /clock"));
  EXPECT_FALSE(watch.isLasting()) << "a simulator that starts needs some seconds";
  for (int i = 0; i < 4; ++i) watch.see(kNoClock, 1.0);
  EXPECT_TRUE(watch.isLasting());
  watch.see(kGood, 1.0);
  EXPECT_THAT(watch.problem(), IsEmpty());
  EXPECT_FALSE(watch.isLasting());
}

TEST(GraphWatch, AClockThatIsPausedIsReportedAfterTenSeconds) {
  GraphWatch watch;
  const GraphSight paused{true, true, true, true};
  for (int i = 0; i < 9; ++i) watch.see(paused, 1.0);
  EXPECT_THAT(watch.problem(), IsEmpty());
  watch.see(paused, 1.0);
  EXPECT_THAT(watch.problem(), HasSubstr("is paused"));
}

}  // namespace
}  // namespace ram_parameters
