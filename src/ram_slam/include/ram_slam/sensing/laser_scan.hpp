// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// What a range reading means (REP 117).
enum class Return {
  kHit,       ///< something at that range
  kNothing,   ///< +Inf: nothing within the sensor's range
  kTooClose,  ///< -Inf: something nearer than the sensor measures
  kInvalid,   ///< NaN, or a finite reading outside the limits: no information
};

/// Meaning of one reading; a reading beyond the limits that is not infinite is invalid.
inline Return classify(float range_m, float range_min_m, float range_max_m) {
  if (range_min_m <= range_m && range_m <= range_max_m) return Return::kHit;
  if (std::isinf(range_m)) return range_m > 0.0F ? Return::kNothing : Return::kTooClose;
  return Return::kInvalid;
}

/// One sweep of a planar lidar, as sensor_msgs/LaserScan has it. Beam i points to
/// angle_min_rad + i * angle_increment_rad (negative increment: clockwise) and was fired i *
/// time_increment_s after stamp_ns. Ranges follow REP 117.
struct LaserScan {
  /// Stands for the limit of a sensor that names none: farther than common lidars see.
  static constexpr float kUnlimitedRangeM = 100.0F;

  std::int64_t stamp_ns = 0;  ///< of the first beam
  double angle_min_rad = 0.0;
  double angle_increment_rad = 0.0;
  double time_increment_s = 0.0;  ///< 0: all beams at once
  float range_min_m = 0.0F;
  float range_max_m = 0.0F;
  std::vector<float> ranges_m;

  double bearing_rad(std::size_t beam) const {
    return angle_min_rad + static_cast<double>(beam) * angle_increment_rad;
  }
  /// From the first beam to the last.
  std::int64_t duration_ns() const;
  /// When the beam with that bearing (plus or minus whole turns) is fired, after stamp_ns.
  std::int64_t delay_ns(double bearing_rad) const;
  Return at(std::size_t beam) const { return classify(ranges_m[beam], range_min_m, range_max_m); }
  /// End point of a beam in the laser's frame [m]; only for beams that hit.
  Eigen::Vector2d end_m(std::size_t beam) const {
    return static_cast<double>(ranges_m[beam]) *
           Eigen::Vector2d(std::cos(bearing_rad(beam)), std::sin(bearing_rad(beam)));
  }

  /// \throws std::invalid_argument with the reason if no use can be made of the scan: no or more
  /// than 20,000 ranges,
  ///         angles or limits not finite, an increment of (nearly) zero, more than a turn,
  ///         range_min > range_max or negative limits
  void validate() const;
};

/// The scan that an upright sensor would have given, from one of a sensor mounted upside down:
/// bearings change sign.
LaserScan mirrored(LaserScan scan);

/// In which order of time the readings of a scan were taken.
enum class SweepDirection {
  kAsStored,          ///< the first reading first
  kCounterclockwise,  ///< by rising bearing, however they are stored
  kClockwise,         ///< by falling bearing, however they are stored
};

/// The scan with its readings in the order in which they were taken.
LaserScan inSweepDirection(SweepDirection direction, LaserScan scan);

/// Gives readings from a range on the meaning that nothing came back: +Inf (REP 117).
void markNoReturns(float from_m, std::vector<float>& ranges_m);

}  // namespace ram_slam
