// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/stages/scan_synchroniser.hpp"

namespace ramscout_bringup {

/// How to read a recording; what is left empty is found in it.
struct RecordingOptions {
  std::string scan_topic;      ///< sensor_msgs/LaserScan or MultiEchoLaserScan
  std::string odometry_topic;  ///< nav_msgs/Odometry
  std::string odom_frame;      ///< where odometry is read from tf: from there to base_frame
  std::string base_frame;      ///< the robot's frame
  std::optional<ram_slam::Pose2> base_from_laser;  ///< instead of the one in the recording
  std::optional<double> fov_rad;  ///< angle between the first and the last beam of FLASER lines
  ram_slam::SweepDirection sweep_direction = ram_slam::SweepDirection::kAsStored;
  double scan_clock_offset_s = 0.0;   ///< added to the stamps of the scans
  double start_s = 0.0;               ///< skipped, from the first scan on
  std::optional<double> duration_s;   ///< read, from there on
  std::optional<double> max_rate_hz;  ///< of scans; more are thinned out
  std::optional<std::size_t> part;    ///< which drive, from 1, if the clock was set back
};

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

  /// Scans that the options ask for, whether they can be used or not.
  virtual std::size_t scanCount() const = 0;
};

}  // namespace ramscout_bringup
