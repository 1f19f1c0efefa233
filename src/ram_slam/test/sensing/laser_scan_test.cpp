// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/sensing/laser_scan.hpp"

#include <functional>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

LaserScan fiveBeams() {
  LaserScan scan;
  scan.angle_min_rad = -0.2;
  scan.angle_increment_rad = 0.1;
  scan.time_increment_s = 0.01;
  scan.range_min_m = 0.1F;
  scan.range_max_m = 10.0F;
  scan.ranges_m = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F};
  return scan;
}

TEST(LaserScan, ReadingsMeanWhatRep117States) {
  EXPECT_EQ(classify(1.0F, 0.1F, 10.0F), Return::kHit);
  EXPECT_EQ(classify(0.1F, 0.1F, 10.0F), Return::kHit);
  EXPECT_EQ(classify(10.0F, 0.1F, 10.0F), Return::kHit);
  EXPECT_EQ(classify(kInfinity, 0.1F, 10.0F), Return::kNothing);
  EXPECT_EQ(classify(-kInfinity, 0.1F, 10.0F), Return::kTooClose);
  EXPECT_EQ(classify(kNan, 0.1F, 10.0F), Return::kInvalid);
  EXPECT_EQ(classify(0.05F, 0.1F, 10.0F), Return::kInvalid);
  EXPECT_EQ(classify(10.5F, 0.1F, 10.0F), Return::kInvalid);
}

TEST(LaserScan, BeamsEndAtTheirRangeAndBearing) {
  const LaserScan scan = fiveBeams();
  EXPECT_NEAR(scan.bearing_rad(0), -0.2, 1e-15);
  EXPECT_NEAR(scan.bearing_rad(4), 0.2, 1e-15);
  EXPECT_NEAR(scan.end_m(2).x(), 3.0, 1e-12);
  EXPECT_NEAR(scan.end_m(2).y(), 0.0, 1e-12);
  EXPECT_NEAR(scan.end_m(4).norm(), 5.0, 1e-12);
}

TEST(LaserScan, TakesTheTimeOfAllItsGaps) {
  EXPECT_EQ(fiveBeams().duration_ns(), 40'000'000);
  LaserScan at_once = fiveBeams();
  at_once.time_increment_s = 0.0;
  EXPECT_EQ(at_once.duration_ns(), 0);
}

TEST(LaserScan, BearingsOfAnotherTurnHaveTheSameDelay) {
  const LaserScan scan = fiveBeams();
  EXPECT_EQ(scan.delay_ns(0.1), 30'000'000);
  EXPECT_EQ(scan.delay_ns(0.1 + 2.0 * M_PI), 30'000'000);
  // Half a beam before the first is still the first.
  EXPECT_EQ(scan.delay_ns(-0.24), 0);
  EXPECT_EQ(scan.delay_ns(-0.24 + 2.0 * M_PI), 0);
  EXPECT_EQ(mirrored(scan).delay_ns(-0.1), 30'000'000);
  EXPECT_EQ(mirrored(scan).delay_ns(0.24 - 2.0 * M_PI), 0);
}

TEST(LaserScan, MirroredTwiceIsTheScanItself) {
  const LaserScan scan = fiveBeams();
  const LaserScan once = mirrored(scan);
  EXPECT_EQ(once.end_m(4).x(), scan.end_m(4).x());
  EXPECT_EQ(once.end_m(4).y(), -scan.end_m(4).y());
  const LaserScan twice = mirrored(once);
  EXPECT_EQ(twice.angle_min_rad, scan.angle_min_rad);
  EXPECT_EQ(twice.angle_increment_rad, scan.angle_increment_rad);
  EXPECT_EQ(twice.ranges_m, scan.ranges_m);
}

TEST(LaserScan, IsRefusedWithoutRangesOrWithWrongGeometry) {
  EXPECT_NO_THROW(fiveBeams().validate());
  const std::function<void(LaserScan&)> damages[] = {
      [](LaserScan& scan) { scan.ranges_m.clear(); },
      [](LaserScan& scan) { scan.ranges_m.resize(20001); },
      [](LaserScan& scan) { scan.angle_min_rad = std::nan(""); },
      [](LaserScan& scan) { scan.angle_increment_rad = 1e-7; },
      [](LaserScan& scan) { scan.time_increment_s = -0.01; },
      [](LaserScan& scan) { scan.range_min_m = -1.0F; },
      [](LaserScan& scan) { scan.range_max_m = scan.range_min_m; },
      [](LaserScan& scan) { scan.range_max_m = kInfinity; },
  };
  for (const auto& damage : damages) {
    LaserScan scan = fiveBeams();
    damage(scan);
    EXPECT_THROW(scan.validate(), std::invalid_argument);
  }
}

}  // namespace
}  // namespace ram_slam
