// SPDX-License-Identifier: BSD-3-Clause
#include "scan_input.hpp"

#include <stdexcept>
#include <utility>

#include "ram_slam/ros/conversions.hpp"

namespace ramscout_feature_detector_ros {
namespace {

constexpr std::size_t kMostLasers = 32;
constexpr double kLogPeriodS = 5.0;

/// A frame without the leading slash that tf2 refuses.
std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

}  // namespace

ScanInput::ScanInput(const std::string& base_frame, Callback use)
    : base_frame_(base_frame), use_(std::move(use)), tf_listener_(tf_buffer_) {
  ros::NodeHandle node;
  scan_subscriber_ =
      node.subscribe("scan", 100, &ScanInput::onScan, this, ros::TransportHints().tcpNoDelay());
}

void ScanInput::onScan(const sensor_msgs::LaserScan& message) {
  try {
    process(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Skipped a scan: " << error.what());
  }
}

void ScanInput::process(const sensor_msgs::LaserScan& message) {
  const std::string laser_frame = withoutSlash(message.header.frame_id);
  if (laser_frame.empty()) throw std::invalid_argument("its frame_id is empty");
  ram_slam::LaserScan scan = ram_slam_ros::toLaserScan(message);
  const ram_slam_ros::Mounting mounting = mountingOf(laser_frame);
  ros::Time& last_stamp = last_stamps_[laser_frame];
  if (message.header.stamp == last_stamp) return;  // the same message again
  last_stamp = message.header.stamp;
  if (mounting.upside_down) scan = ram_slam::mirrored(std::move(scan));
  use_(scan, mounting.base_from_sensor);
}

ram_slam_ros::Mounting ScanInput::mountingOf(const std::string& laser_frame) {
  const auto known = mountings_.find(laser_frame);
  if (known != mountings_.end()) return known->second;
  if (mountings_.size() >= kMostLasers) {
    throw std::invalid_argument("more than " + std::to_string(kMostLasers) + " laser frames");
  }
  const auto transform = tf_buffer_.lookupTransform(base_frame_, laser_frame, ros::Time(0));
  const ram_slam_ros::Mounting mounting = ram_slam_ros::toMounting(transform.transform);
  mountings_[laser_frame] = mounting;
  ROS_INFO_STREAM("Laser " << laser_frame << (mounting.upside_down ? " (upside down)" : "")
                           << " at " << mounting.base_from_sensor.x_m << ", "
                           << mounting.base_from_sensor.y_m << " m, "
                           << mounting.base_from_sensor.yaw_rad << " rad");
  return mounting;
}

}  // namespace ramscout_feature_detector_ros
