// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ramscout_bringup/carmen_log.hpp"
#include "ramscout_bringup/recording.hpp"

namespace ramscout_bringup {

/// A CARMEN log as a recording: each scan follows the odometry of its own stamp, if the log has
/// odometry.
class CarmenRecording : public Recording {
public:
  /// \throws std::runtime_error as readCarmenLog()
  explicit CarmenRecording(const std::string& path, const RecordingOptions& options = {});

  std::optional<Reading> next() override;
  double progress() const override;
  std::vector<std::string> notes() const override;
  std::size_t scanCount() const override {
    return log_.scans.size() + log_.damaged_line_count + log_.duplicate_scan_count +
           log_.stray_scan_count;
  }

private:
  CarmenLog log_;
  std::size_t scan_ = 0;
  bool odometry_given_ = false;  ///< of scan_
};

}  // namespace ramscout_bringup
