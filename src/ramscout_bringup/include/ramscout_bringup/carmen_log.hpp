// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_bringup/recording.hpp"

namespace ramscout_bringup {

/// What a CARMEN log contains about the front laser and the wheels.
struct CarmenLog {
  /// In strictly rising stamp order; readings follow REP 117.
  std::vector<ram_slam::LaserScan> scans;
  /// One per scan, at its stamp: the pose that the laser's line carries. Empty if the log's
  /// odometry never moves.
  std::vector<ram_slam::StampedPose2> odometry;
  /// The laser's mount, from the two poses of each laser line; identity if they do not differ by a
  /// constant.
  ram_slam::Pose2 base_from_laser;
  bool mount_is_known = false;
  /// The reading that the sensor gives for "nothing there", if the log has one; such readings are
  /// +Inf in `scans`.
  std::optional<float> no_return_m;
  std::size_t damaged_line_count = 0;     ///< laser lines that could not be read
  std::size_t duplicate_scan_count = 0;   ///< laser lines left out since another had the same stamp
  std::size_t stray_scan_count = 0;       ///< laser lines whose stamp does not fit the others
  std::vector<std::string> notes;         ///< what was decided about the stamps
  std::optional<double> assumed_fov_rad;  ///< of FLASER lines: they carry no geometry
  std::size_t assumed_beam_count = 0;     ///< that it was assumed for
};

/// Reads the laser lines (FLASER, ROBOTLASER1) of a CARMEN log, plain or packed (.gz, .xz).
///
/// Stamps are those of the message, not of the logger. ODOM lines are not used: the pose in the
/// laser's line is the one of the laser's stamp. FLASER carries no geometry; by CARMEN's convention
/// n readings cover 180 deg, the first at -90 deg: 180 and 360 readings are 180/n deg apart, 181
/// and 361 are 180/(n-1) deg. The usual numbers of Hokuyo's lidars have their fields of view.
///
/// \param options  fov_rad, base_from_laser, sweep_direction, start_s, duration_s,
/// max_rate_hz and part count
/// \throws std::runtime_error naming the file if it cannot be read or has no laser line
CarmenLog readCarmenLog(const std::string& path, const RecordingOptions& options = {});

}  // namespace ramscout_bringup
