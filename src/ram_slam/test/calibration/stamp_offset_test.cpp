// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/stamp_offset.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

/// How a robot swings to and fro, and how scans and wheels see it.
struct Drive {
  double offset_s = 0.0;     ///< of the scans: they show where the robot is that much later
  double wheel_ratio = 1.0;  ///< turns by the wheels over the true ones
  double scan_period_s = 0.1;
  double duration_s = 120.0;
  double max_offset_s = 0.3;
  double rate_radps = 0.8;  ///< of the swing; 0: it turns at a constant rate
  double scan_deviation_rad = 0.002;

  double yawAt(double time_s) const {
    return rate_radps == 0.0 ? time_s : 1.5 * std::sin(rate_radps * time_s);
  }
};

/// The offset [s] that is learned in a drive; \param until  after which there is no offset any more
double learn(const Drive& drive, double until_s = 1e9) {
  StampOffset learner(drive.max_offset_s);
  Random random(7, 0);
  double next_scan_s = 0.1;
  for (int step = 1; step * 0.02 < drive.duration_s; ++step) {
    const double time_s = step * 0.02;
    const auto stamp_ns = static_cast<std::int64_t>(std::llround(time_s * 1e9));
    learner.addWheels({stamp_ns, {0.0, 0.0, drive.wheel_ratio * drive.yawAt(time_s)}});
    if (time_s < next_scan_s) continue;
    next_scan_s += drive.scan_period_s;
    const double offset_s = time_s < until_s ? drive.offset_s : 0.0;
    const double yaw_rad =
        drive.yawAt(time_s + offset_s) + drive.scan_deviation_rad * random.gaussian();
    learner.addScan({stamp_ns, {0.0, 0.0, wrapAngle(yaw_rad)}});
  }
  return 1e-9 * static_cast<double>(learner.offset_ns());
}

TEST(StampOffset, IsLearnedWhileTheTurnRateChanges) {
  for (const double offset_s : {0.14, -0.08, 0.05, -0.22}) {
    Drive drive;
    drive.offset_s = offset_s;
    EXPECT_NEAR(learn(drive), offset_s, 0.01);
  }
}

TEST(StampOffset, IsZeroWhereThereIsNone) {
  EXPECT_EQ(learn({}), 0.0);
}

TEST(StampOffset, IsNotSeenInATurnAtConstantRate) {
  Drive drive;
  drive.offset_s = 0.14;
  drive.rate_radps = 0.0;
  EXPECT_EQ(learn(drive), 0.0);
}

TEST(StampOffset, OfWheelsThatTurnTooFarIsStillZero) {
  for (const double ratio : {0.7, 1.1, 1.3, 1.6}) {
    Drive drive;
    drive.wheel_ratio = ratio;
    EXPECT_EQ(learn(drive), 0.0) << ratio;
  }
}

TEST(StampOffset, OfWheelsThatTurnTheOtherWayIsZero) {
  // A scanner whose readings are in reverse order turns against the wheels.
  Drive drive;
  drive.wheel_ratio = -1.0;
  EXPECT_EQ(learn(drive), 0.0);
}

TEST(StampOffset, BeyondTheGreatestOneIsNotUsed) {
  Drive drive;
  drive.offset_s = 0.45;
  EXPECT_EQ(learn(drive), 0.0);
}

TEST(StampOffset, IsNotLearnedFromScansThatComeTooSeldom) {
  Drive drive;
  drive.offset_s = 0.14;
  drive.scan_period_s = 0.5;
  EXPECT_EQ(learn(drive), 0.0);
}

TEST(StampOffset, IsZeroUntilEnoughTurnsAreSeen) {
  Drive drive;
  drive.offset_s = 0.14;
  drive.duration_s = 20.0;
  EXPECT_EQ(learn(drive), 0.0);
}

TEST(StampOffset, IsTakenBackWhenItDoesNotPredictTheTurnsAnyMore) {
  Drive drive;
  drive.offset_s = 0.14;
  EXPECT_GT(learn(drive), 0.1);
  drive.duration_s = 240.0;
  EXPECT_EQ(learn(drive, 120.0), 0.0);
}

TEST(StampOffset, CanBeSwitchedOff) {
  Drive drive;
  drive.offset_s = 0.14;
  drive.max_offset_s = 0.0;
  EXPECT_EQ(learn(drive), 0.0);
  EXPECT_THROW(StampOffset(-0.1), std::invalid_argument);
  EXPECT_THROW(StampOffset(2.0), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
