// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/stages/scan_synchroniser.hpp"

namespace ramscout_bringup {

/// A robot's log as the sensors wrote it, in the order of the stamps; of equal stamps odometry
/// comes first.
class Recording {
public:
  /// Odometry (odom_from_base at an instant), or a scan with its mount.
  using Reading = std::variant<ram_slam::StampedPose2, ram_slam::MountedScan>;

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
