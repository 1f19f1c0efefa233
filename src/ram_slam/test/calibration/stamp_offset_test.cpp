// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/stamp_offset.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

/// A robot that swings to and fro; wheels at 50 Hz, scans at 10 Hz whose stamps lag or lead.
std::int64_t learn(double offset_s, double max_offset_s, double duration_s) {
  StampOffset learner(max_offset_s);
  const auto yawAt = [](double time_s) { return 1.5 * std::sin(0.8 * time_s); };
  for (int step = 1; step * 0.02 < duration_s; ++step) {
    const double time_s = step * 0.02;
    const auto stamp_ns = static_cast<std::int64_t>(std::llround(time_s * 1e9));
    learner.addWheels({stamp_ns, {0.0, 0.0, yawAt(time_s)}});
    if (step % 5 == 0) learner.addScan({stamp_ns, {0.0, 0.0, yawAt(time_s + offset_s)}});
  }
  return learner.offset_ns();
}

TEST(StampOffset, IsLearnedWhileTurning) {
  EXPECT_NEAR(1e-9 * static_cast<double>(learn(0.14, 0.3, 60.0)), 0.14, 0.005);
  EXPECT_NEAR(1e-9 * static_cast<double>(learn(-0.08, 0.3, 60.0)), -0.08, 0.005);
}

TEST(StampOffset, IsZeroWhereThereIsNone) {
  EXPECT_EQ(learn(0.0, 0.3, 60.0), 0);
}

TEST(StampOffset, IsZeroUntilEnoughTurnsAreSeen) {
  EXPECT_EQ(learn(0.14, 0.3, 3.0), 0);
}

TEST(StampOffset, CanBeSwitchedOff) {
  EXPECT_EQ(learn(0.14, 0.0, 60.0), 0);
  EXPECT_THROW(StampOffset(-0.1), std::invalid_argument);
  EXPECT_THROW(StampOffset(2.0), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
