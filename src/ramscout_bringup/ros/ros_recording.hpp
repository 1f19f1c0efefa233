// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <ram_slam/ros/mounting.hpp>

#include "ramscout_bringup/recording.hpp"
#include "ramscout_bringup/transform_tree.hpp"

#include "message_source.hpp"
#include "recording_survey.hpp"

namespace ramscout_bringup_ros {

/// A file of ROS messages as a recording: scans and odometry in the order of their header stamps,
/// however the file was written. The file is read twice: the first time to find out what it holds
/// (see docs/recordings.md), the second time for the scans. Needs no master.
class RosRecording : public ramscout_bringup::Recording {
public:
  /// \throws std::runtime_error if the file cannot be read, or if what it holds is ambiguous or of
  /// no use: the message names the candidates and the option that decides
  RosRecording(std::unique_ptr<MessageSource> source,
               const ramscout_bringup::RecordingOptions& options);

  std::optional<Reading> next() override;
  double progress() const override;
  std::vector<std::string> notes() const override;
  std::size_t scanCount() const override { return plan_.scan_count; }

private:
  /// Reads scans until the next one in the order of their stamps is at hand; false at the end.
  bool fetchScan();
  void takeScan(const sensor_msgs::LaserScan& message, std::size_t index);
  ram_slam_ros::Mounting mountOf(const std::string& frame, std::int64_t stamp_ns);

  std::unique_ptr<MessageSource> source_;
  ramscout_bringup::RecordingOptions options_;
  RecordingSurvey survey_;
  RecordingPlan plan_;
  std::size_t scans_read_ = 0;
  std::map<std::size_t, std::optional<ram_slam::MountedScan>> waiting_;  ///< by rank
  std::size_t rank_ = 0;                                                 ///< of the next scan
  std::size_t odometry_ = 0;                                             ///< index of the next one
  std::map<std::string, ram_slam_ros::Mounting> constant_mounts_;        ///< by frame
  std::map<std::string, std::size_t> left_out_;                          ///< by reason
};

/// Opens a recording, whatever its name: ROS bag, MCAP, SQLite (.db3), a folder with one of these,
/// or CARMEN log.
/// \throws std::runtime_error as its reader, or if an option does not apply to the format
std::unique_ptr<ramscout_bringup::Recording> openRecording(
    const std::string& path, const ramscout_bringup::RecordingOptions& options);

}  // namespace ramscout_bringup_ros
