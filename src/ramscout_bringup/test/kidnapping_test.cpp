// SPDX-License-Identifier: BSD-3-Clause
#include "../benchmark/kidnapping.hpp"

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

TEST(KidnappedRobot, IsFoundAgainAndItsMapIsAsItWas) {
  constexpr double kMost_m = 30.0;
  KidnappedRobot robot(CONFIG_FOLDER, 2);
  robot.map();
  ASSERT_GT(robot.landmarkCount(), 40U);
  for (int i = 0; i < 2; ++i) {
    const Kidnapping result = robot.kidnap(kMost_m);
    EXPECT_GE(result.lost_after_s, 0.0) << "never noticed";
    EXPECT_LE(result.lost_after_s, 2.0);
    EXPECT_GE(result.recovered_after_m, 0.0) << "not found";
    EXPECT_LE(result.recovered_after_m, kMost_m);
    EXPECT_LE(result.longest_wrong_s, 5.0);
    EXPECT_TRUE(result.map_untouched);
  }
}

}  // namespace
}  // namespace ramscout_bringup
