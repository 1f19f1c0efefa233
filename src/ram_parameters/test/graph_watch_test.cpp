// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/graph_watch.hpp"

#include <gmock/gmock.h>

namespace ram_parameters {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr GraphSight kGood{true, true, false};
constexpr GraphSight kNoMaster{false, false, false};
constexpr GraphSight kForgotten{true, false, false};
constexpr GraphSight kNoClock{true, true, true};

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

TEST(GraphWatch, SimulatedTimeWithoutAClockIsReportedAfterThreeSeconds) {
  GraphWatch watch;
  watch.see(kNoClock, 1.0);
  watch.see(kNoClock, 1.0);
  EXPECT_THAT(watch.problem(), IsEmpty());
  watch.see(kNoClock, 1.0);
  EXPECT_THAT(watch.problem(), HasSubstr("nothing comes on /clock"));
  watch.see(kGood, 1.0);
  EXPECT_THAT(watch.problem(), IsEmpty());
}

}  // namespace
}  // namespace ram_parameters
