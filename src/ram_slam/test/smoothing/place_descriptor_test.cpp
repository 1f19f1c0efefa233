// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/place_descriptor.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "key_scan_drive.hpp"

namespace ram_slam {
namespace {

constexpr double kRangeM = 12.0;

PlaceDescriptor at(const Walls& walls, const Pose2& pose) {
  const KeyScans scans = scansAt(walls, {pose}, {pose});
  return describePlace(scans.keys().front().surfaces, kRangeM);
}

TEST(PlaceDescriptor, SharesOfAllPairsSumToOne) {
  float sum = 0.0F;
  for (const float share : at(pillarRoom(), {})) sum += share;
  EXPECT_NEAR(sum, 1.0F, 1e-3F);
}

TEST(PlaceDescriptor, IsTheSameInAnyHeadingOfTheRobot) {
  const PlaceDescriptor ahead = at(pillarRoom(), {});
  for (const double yaw_rad : {0.7, M_PI_2, M_PI})
    EXPECT_GT(likeness(ahead, at(pillarRoom(), {0.0, 0.0, yaw_rad})), 0.9) << yaw_rad;
}

TEST(PlaceDescriptor, IsLessAlikeOfAnotherRoomThanOfTheSameSeenElsewhere) {
  const PlaceDescriptor room = at(pillarRoom(), {});
  const PlaceDescriptor hall = at(rectangle(-10.0, -1.0, 10.0, 1.0), {});
  EXPECT_GT(likeness(room, at(pillarRoom(), {0.5, 0.3, 1.0})), likeness(room, hall) + 0.2);
}

TEST(PlaceDescriptor, IsEmptyWithoutWallsAndLikeNothing) {
  EXPECT_TRUE(describePlace(SurfaceScan{}, kRangeM).empty());
  EXPECT_EQ(likeness({}, at(pillarRoom(), {})), 0.0);
}

TEST(Likeness, IsTheShareInCommon) {
  EXPECT_NEAR(likeness({0.5F, 0.5F, 0.0F}, {0.25F, 0.5F, 0.25F}), 0.75, 1e-6);
}

}  // namespace
}  // namespace ram_slam
