// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/motion_gate.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr MotionGate kGate{0.5, 0.25};

TEST(MotionGate, IsReachedByDistanceOrAngleAlone) {
  EXPECT_TRUE(kGate.isReachedBy({0.3, 0.4, 0.0}));  // 0.5 m in both axes together
  EXPECT_TRUE(kGate.isReachedBy({0.0, 0.0, -0.25}));
  EXPECT_FALSE(kGate.isReachedBy({0.4, 0.0, 0.2}));
}

TEST(MotionGate, IsExceededOnlyBeyondItsBounds) {
  EXPECT_FALSE(kGate.isExceededBy({0.3, 0.4, -0.25}));
  EXPECT_TRUE(kGate.isExceededBy({0.0, -0.51, 0.0}));
  EXPECT_TRUE(kGate.isExceededBy({0.0, 0.0, 0.26}));
}

}  // namespace
}  // namespace ram_slam
