// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// Finds a lidar whose readings are mirrored: mounted upside down while tf has it upright, or the
/// other way round. Wheels and scans then turn against each other.
///
/// Of each turn by the wheels, the ranges of the scan after it are compared with those before it
/// twice: turned with the wheels, and against them. What fits better in the sum over many turns is
/// true.
class MirrorCheck {
public:
  /// \param scan  as mounted by tf: mirrored already if it is upside down there
  /// \param odom_yaw_rad  of the wheels at its stamp
  void add(const LaserScan& scan, double odom_yaw_rad);

  /// Whether the readings are mirrored; decided after turning by about half a radian.
  bool isMirrored() const { return is_mirrored_; }

private:
  static constexpr double kLeastTurn_rad = 0.1;  ///< several beams of every lidar
  static constexpr double kMostTurn_rad = 0.5;   ///< the robot may have moved on by then
  static constexpr double kLimit_m = 0.5;        ///< a difference beyond that is another surface
  static constexpr double kMostRange_m = 30.0;
  static constexpr int kLeastBeams = 30;
  static constexpr double kMemory = 0.9;  ///< by which older turns count less
  static constexpr double kLeastSum_rad = 0.3;
  static constexpr double kClearRatio = 1.5;  ///< of the two differences

  /// Mean difference of the ranges in m if the laser turned by that angle; nothing if too few
  /// beams see something.
  std::optional<double> difference_m(const LaserScan& scan, double turn_rad) const;

  LaserScan last_;
  double last_yaw_rad_ = 0.0;
  double with_wheels_m_ = 0.0;  ///< differences, weighted
  double against_wheels_m_ = 0.0;
  double turned_rad_ = 0.0;  ///< what they are the sum of
  bool is_mirrored_ = false;
};

}  // namespace ram_slam
