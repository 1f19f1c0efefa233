// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/sensing/laser_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "ram_slam/sensing/swept_angle.hpp"

namespace ram_slam {
namespace {

/// More than planar lidars give: a longer message is damaged.
constexpr std::size_t kMaxBeams = 20000;
/// A whole turn would take six million beams.
constexpr double kMinIncrementRad = 1e-6;
/// A turn, and some beams that are measured twice.
constexpr double kMaxAngleRad = 2.0 * M_PI + 0.2;

}  // namespace

void LaserScan::validate() const {
  if (ranges_m.empty()) throw std::invalid_argument("scan without ranges");
  if (ranges_m.size() > kMaxBeams) {
    throw std::invalid_argument("scan of " + std::to_string(ranges_m.size()) + " beams, at most " +
                                std::to_string(kMaxBeams) + " are taken");
  }
  if (!std::isfinite(angle_min_rad) || !std::isfinite(angle_increment_rad) ||
      std::abs(angle_increment_rad) < kMinIncrementRad) {
    throw std::invalid_argument("scan with angle_min " + std::to_string(angle_min_rad) +
                                " and angle_increment " + std::to_string(angle_increment_rad));
  }
  const auto steps = static_cast<double>(std::max<std::size_t>(ranges_m.size(), 2) - 1);
  const double angle_rad = std::abs(angle_increment_rad) * steps;
  if (angle_rad > kMaxAngleRad) {
    throw std::invalid_argument("scan over " + std::to_string(angle_rad) +
                                " rad, more than a turn: are its angles in degrees?");
  }
  if (std::abs(angle_min_rad) > 2.0 * kMaxAngleRad) {
    throw std::invalid_argument("scan that begins at " + std::to_string(angle_min_rad) +
                                " rad, more than a turn: are its angles in degrees?");
  }
  if (!std::isfinite(time_increment_s) || time_increment_s < 0.0) {
    throw std::invalid_argument("scan with time_increment " + std::to_string(time_increment_s));
  }
  if (!std::isfinite(range_min_m) || !std::isfinite(range_max_m) || range_min_m < 0.0F ||
      range_max_m <= range_min_m) {
    throw std::invalid_argument("scan with range limits [" + std::to_string(range_min_m) + ", " +
                                std::to_string(range_max_m) + "]");
  }
}

std::int64_t LaserScan::duration_ns() const {
  const double last = static_cast<double>(std::max<std::size_t>(ranges_m.size(), 1) - 1);
  return std::llround(1e9 * time_increment_s * last);
}

std::int64_t LaserScan::delay_ns(double bearing_rad) const {
  const double beams =
      sweptAngle_rad(bearing_rad, angle_min_rad, angle_increment_rad) / angle_increment_rad;
  return std::llround(1e9 * time_increment_s * std::max(beams, 0.0));
}

LaserScan mirrored(LaserScan scan) {
  scan.angle_min_rad = -scan.angle_min_rad;
  scan.angle_increment_rad = -scan.angle_increment_rad;
  return scan;
}

LaserScan inSweepDirection(SweepDirection direction, LaserScan scan) {
  const bool is_counterclockwise = scan.angle_increment_rad > 0.0;
  if (direction == SweepDirection::kAsStored ||
      (direction == SweepDirection::kCounterclockwise) == is_counterclockwise) {
    return scan;
  }
  scan.angle_min_rad = scan.bearing_rad(scan.ranges_m.size() - 1);
  scan.angle_increment_rad = -scan.angle_increment_rad;
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  return scan;
}

void markNoReturns(float from_m, std::vector<float>& ranges_m) {
  for (float& range_m : ranges_m)
    if (range_m >= from_m) range_m = std::numeric_limits<float>::infinity();
}

}  // namespace ram_slam
