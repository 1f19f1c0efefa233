// SPDX-License-Identifier: BSD-3-Clause
#include "ros_recording.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

#include <ram_slam/ros/conversions.hpp>
#include <tf2_eigen/tf2_eigen.h>

#include "ramscout_bringup/carmen_recording.hpp"
#include "ramscout_bringup/named_file.hpp"

namespace ramscout_bringup_ros {
RosRecording::RosRecording(std::unique_ptr<MessageSource> source,
                           const ramscout_bringup::RecordingOptions& options)
    : source_(std::move(source)),
      options_(options),
      survey_(survey(*source_, options)),
      plan_(plan(survey_, options)) {
  source_->restart({survey_.scans.topic});
}

std::optional<RosRecording::Reading> RosRecording::next() {
  while (fetchScan()) {
    const auto scan = waiting_.find(rank_);
    if (scan->second && odometry_ < plan_.odometry.size() &&
        plan_.odometry[odometry_].stamp_ns <= scan->second->scan.stamp_ns) {
      return plan_.odometry[odometry_++];
    }
    std::optional<Reading> reading;
    if (scan->second) reading.emplace(std::move(*scan->second));
    waiting_.erase(scan);
    ++rank_;
    if (reading) return reading;
  }
  if (odometry_ < plan_.odometry.size()) return plan_.odometry[odometry_++];
  return std::nullopt;
}

bool RosRecording::fetchScan() {
  while (waiting_.count(rank_) == 0) {
    const auto message = source_->next();
    if (!message) return false;
    const auto* scan = std::get_if<sensor_msgs::LaserScan>(&message->content);
    if (!scan) continue;  // a topic can carry messages of several types
    const std::size_t index = scans_read_++;
    if (index >= plan_.scan_ranks.size()) {
      ++left_out_["the damaged file gives them only when it is read again"];
      continue;
    }
    if (plan_.scan_ranks[index]) takeScan(*scan, index);
  }
  return true;
}

void RosRecording::takeScan(const sensor_msgs::LaserScan& message, std::size_t index) {
  std::optional<ram_slam::MountedScan>& place = waiting_[*plan_.scan_ranks[index]];
  try {
    sensor_msgs::LaserScan corrected = message;
    corrected.header.stamp = ram_slam_ros::toTime(plan_.scan_stamps_ns[index]);
    ram_slam::LaserScan scan = ram_slam_ros::toLaserScan(corrected);
    if (plan_.sweep_s)
      scan.time_increment_s = *plan_.sweep_s / static_cast<double>(scan.ranges_m.size());
    if (plan_.no_return_m) {
      scan.range_max_m =
          std::min(scan.range_max_m, ram_slam::NoReturnDetector::limit_m(*plan_.no_return_m));
      ram_slam::markNoReturns(scan.range_max_m, scan.ranges_m);
    }
    scan = ram_slam::inSweepDirection(options_.sweep_direction, std::move(scan));
    const auto mount = mountOf(message.header.frame_id, scan.stamp_ns);
    if (mount.upside_down) scan = ram_slam::mirrored(std::move(scan));
    place = ram_slam::MountedScan{std::move(scan), mount.base_from_sensor};
  } catch (const std::exception& error) {
    ++left_out_[error.what()];
  }
}

ram_slam_ros::Mounting RosRecording::mountOf(const std::string& frame, std::int64_t stamp_ns) {
  if (options_.base_from_laser) return {*options_.base_from_laser, false};
  const auto known = constant_mounts_.find(frame);
  if (known != constant_mounts_.end()) return known->second;
  ram_slam_ros::Mounting mount;
  if (survey_.tree.connects(plan_.base_frame, frame)) {
    const auto base_from_laser = survey_.tree.lookup(plan_.base_frame, frame, stamp_ns);
    if (!base_from_laser)
      throw std::invalid_argument("the laser's mount moves, and tf does not know it at the stamp");
    mount = ram_slam_ros::toMounting(tf2::eigenToTransform(*base_from_laser).transform);
  }
  if (survey_.tree.isConstant(plan_.base_frame, frame)) constant_mounts_[frame] = mount;
  return mount;
}

double RosRecording::progress() const {
  return static_cast<double>(rank_) / static_cast<double>(plan_.read_count);
}

std::vector<std::string> RosRecording::notes() const {
  std::vector<std::string> notes = plan_.notes;
  for (const auto& [reason, count] : left_out_)
    notes.push_back("left out " + std::to_string(count) + " scans: " + reason);
  notes.insert(notes.end(), survey_.source_notes.begin(), survey_.source_notes.end());
  return notes;
}

namespace {

/// The one recording in a folder that rosbag2 wrote.
std::string fileIn(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (extension == ".mcap" || extension == ".db3") files.push_back(entry.path().string());
  }
  if (files.size() == 1) return files.front();
  throw std::runtime_error(folder.string() + " has " + std::to_string(files.size()) +
                           " recordings (.mcap, .db3), wanted one: name the file");
}

std::unique_ptr<RosRecording> openRos(std::unique_ptr<MessageSource> source,
                                      const ramscout_bringup::RecordingOptions& options) {
  if (options.fov_rad)
    throw std::runtime_error("--fov is for CARMEN logs: ROS scans carry their angles");
  return std::make_unique<RosRecording>(std::move(source), options);
}

void refuseRosOptions(const ramscout_bringup::RecordingOptions& options) {
  if (options.scan_topic.empty() && options.odometry_topic.empty() && options.odom_frame.empty() &&
      options.base_frame.empty() && options.scan_clock_offset_s == 0.0)
    return;
  throw std::runtime_error(
      "this is a CARMEN log: --scan-topic, --odom-topic, --odom-frame, --base-frame and "
      "--scan-clock-offset are for recordings of ROS messages");
}

}  // namespace

std::unique_ptr<ramscout_bringup::Recording> openRecording(
    const std::string& path, const ramscout_bringup::RecordingOptions& options) {
  if (std::filesystem::is_directory(path)) return openRecording(fileIn(path), options);
  std::string beginning(16, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  const auto begins = [&](const std::string& magic) { return beginning.rfind(magic, 0) == 0; };
  return ramscout_bringup::namingFile(path, [&]() -> std::unique_ptr<ramscout_bringup::Recording> {
    if (begins("#ROSBAG V")) return openRos(openBag(path), options);
    if (begins("\x89MCAP")) return openRos(openMcap(path), options);
    if (begins("SQLite format 3")) return openRos(openSqlite(path), options);
    refuseRosOptions(options);
    return std::make_unique<ramscout_bringup::CarmenRecording>(path, options);
  });
}

}  // namespace ramscout_bringup_ros
