// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/authority_guard.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(AuthorityGuard, OnePublisherPerFrameIsAsItShouldBe) {
  AuthorityGuard guard;
  for (int i = 0; i < 100; ++i) {
    guard.add("map", "odom", "/fast_slam", 0.1 * i);
    guard.add("odom", "base_link", "/driver", 0.1 * i);
    EXPECT_THAT(guard.conflict(0.1 * i), IsEmpty());
  }
}

TEST(AuthorityGuard, ASecondEstimatorIsReportedWithBothNamesWhileItRuns) {
  AuthorityGuard guard;
  guard.add("map", "odom", "/fast_slam", 10.0);
  guard.add("map", "odom", "/fast_slam_2", 10.1);
  EXPECT_THAT(guard.conflict(10.2),
              AllOf(HasSubstr("map -> odom from /fast_slam and map -> odom from /fast_slam_2"),
                    HasSubstr("stop one of them")));
  guard.add("map", "odom", "/fast_slam", 14.0);
  EXPECT_THAT(guard.conflict(14.0), IsEmpty());
}

TEST(AuthorityGuard, ASecondSourceOfOdometryIsReportedThoughItsParentFrameDiffers) {
  AuthorityGuard guard;
  guard.add("odom", "base_link", "/driver", 10.0);
  guard.add("odom_combined", "base_link", "/ekf", 10.0);
  EXPECT_THAT(guard.conflict(10.0), HasSubstr("the transform to base_link"));
}

}  // namespace
}  // namespace ram_slam
