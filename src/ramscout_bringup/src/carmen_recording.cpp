// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/carmen_recording.hpp"

#include <cmath>
#include <sstream>
#include <utility>

namespace ramscout_bringup {

CarmenRecording::CarmenRecording(const std::string& path, const RecordingOptions& options)
    : log_(readCarmenLog(path, options)) {}

std::optional<Recording::Reading> CarmenRecording::next() {
  if (scan_ == log_.scans.size()) return std::nullopt;
  if (!log_.odometry.empty() && !odometry_given_) {
    odometry_given_ = true;
    return log_.odometry[scan_];
  }
  odometry_given_ = false;
  return ram_slam::MountedScan{std::move(log_.scans[scan_++]), log_.base_from_laser};
}

double CarmenRecording::progress() const {
  return static_cast<double>(scan_) / static_cast<double>(log_.scans.size());
}

std::vector<std::string> CarmenRecording::notes() const {
  std::vector<std::string> notes{"scans: " + std::to_string(log_.scans.size()),
                                 "odometry: " + std::to_string(log_.odometry.size())};
  notes.insert(notes.end(), log_.notes.begin(), log_.notes.end());
  if (log_.assumed_fov_rad) {
    std::ostringstream fov;
    fov << "FLASER lines carry no angles: " << log_.assumed_beam_count << " beams are assumed over "
        << std::round(*log_.assumed_fov_rad * 180.0 / M_PI) << " deg; give them with --fov";
    notes.push_back(fov.str());
  }
  // An offset of 1e-9 m comes from rounding in the log.
  const auto rounded = [](double value) { return std::round(1e6 * value) / 1e6 + 0.0; };
  std::ostringstream mount;
  mount << "laser on the base: x " << rounded(log_.base_from_laser.x_m) << " m, y "
        << rounded(log_.base_from_laser.y_m) << " m, yaw " << rounded(log_.base_from_laser.yaw_rad)
        << " rad" << (log_.mount_is_known ? "" : " (assumed: the log does not contain it)");
  notes.push_back(mount.str());
  if (log_.no_return_m) {
    notes.push_back("readings of " + std::to_string(*log_.no_return_m) +
                    " m and more mean: nothing there");
  }
  if (log_.damaged_line_count > 0) {
    notes.push_back("left out " + std::to_string(log_.damaged_line_count) +
                    " laser lines: damaged, or without a use");
  }
  if (log_.duplicate_scan_count > 0) {
    notes.push_back("left out " + std::to_string(log_.duplicate_scan_count) +
                    " scans with the stamp of another");
  }
  return notes;
}

}  // namespace ramscout_bringup
