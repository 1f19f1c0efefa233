// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ramscout_bringup {

/// What the odometry said at one instant.
struct OdometryReading {
  std::int64_t stamp_ns = 0;
  ram_slam::Pose2 odom_from_base;
};

/// One scan and where the laser was mounted when it was taken.
struct ScanReading {
  ram_slam::LaserScan scan;
  ram_slam::Pose2 base_from_laser;

  std::int64_t stampNs() const { return scan.stamp_ns; }
};

/// A robot's log as the sensors wrote it, in the order of the stamps; of equal stamps odometry
/// comes first.
class Recording {
public:
  using Reading = std::variant<OdometryReading, ScanReading>;

  virtual ~Recording() = default;

  /// The next reading, or nothing at the end.
  /// \throws std::runtime_error if the file cannot be read on
  virtual std::optional<Reading> next() = 0;

  /// Part of the recording that next() has given so far, from 0 to 1.
  virtual double progress() const = 0;

  /// What was found and decided about the recording, for the user: topics, geometry, what was left
  /// out and why.
  virtual std::vector<std::string> notes() const = 0;
};

}  // namespace ramscout_bringup
