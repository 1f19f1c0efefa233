// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/tracking_gate.hpp"

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

TEST(TrackingGate, AdmitsEverythingUntilTheRobotIsLost) {
  EXPECT_TRUE(TrackingGate().admits(1));
  EXPECT_FALSE(TrackingGate(true).admits(1));
}

TEST(TrackingGate, LeavesOutWhatWasSeenWhileThePoseWasUncertain) {
  TrackingGate gate;
  gate.set({true, 100, 70, {}});
  EXPECT_TRUE(gate.admits(70));
  EXPECT_FALSE(gate.admits(71));
  EXPECT_FALSE(gate.admits(200));
  gate.set({false, 150, 150, {}});
  EXPECT_TRUE(gate.admits(70));
  EXPECT_FALSE(gate.admits(71));
  EXPECT_FALSE(gate.admits(150));
  EXPECT_TRUE(gate.admits(151));
}

TEST(TrackingGate, AnotherMessageThatTheRobotIsTrackedChangesNothing) {
  TrackingGate gate;
  gate.set({false, 100, 100, {}});
  EXPECT_TRUE(gate.admits(50));
}

}  // namespace
}  // namespace ram_slam
