// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <ram_slam_msgs/LidarCalibration.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>

#include "ram_slam/calibration/lidar_calibration.hpp"
#include "ram_slam/sensing/placed_scan.hpp"
#include "ram_slam/stages/input_guard.hpp"
#include "ram_slam/stages/loss_counter.hpp"
#include "ram_slam/stages/scan_synchroniser.hpp"

namespace ram_slam_ros {

/// Turns scan messages into scans with the laser's mount, which tf knows sooner or later. Scans of
/// a sensor mounted upside down are mirrored. What cannot be used is counted.
class MountedScans {
public:
  /// \param transforms  outlives this
  MountedScans(std::string base_frame, const tf2_ros::Buffer& transforms)
      : base_frame_(std::move(base_frame)), transforms_(transforms) {}

  /// Corrects the scans as laser_odometry does, by what it publishes on `lidar_calibration`.
  void followCalibration(ros::NodeHandle& node);

  /// \return whether the stamps show that the clock was set back; then what waited is dropped
  bool add(const ros::MessageEvent<const sensor_msgs::LaserScan>& event,
           ram_slam::DropCounter& drops);
  /// The next scan whose mount is known; nothing if it still waits. A scan that waited for a second
  /// of wall time is dropped.
  std::optional<ram_slam::MountedScan> next(ram_slam::DropCounter& drops);
  void clear() {
    waiting_.clear();
    guard_ = {};
  }

  /// What came, and what was lost on its way.
  const ram_slam::LossCounter& messages() const { return messages_; }

private:
  struct Waiting {
    ram_slam::LaserScan scan;
    std::string frame;
    ros::SteadyTime since;
  };

  void onCalibration(const ram_slam_msgs::LidarCalibration& message);

  std::string base_frame_;
  const tf2_ros::Buffer& transforms_;
  ros::Subscriber calibration_;
  double added_mirror_turn_s_ = 0.0;
  ram_slam::InputGuard<Waiting> guard_;
  ram_slam::LossCounter messages_;
  std::deque<Waiting> waiting_;
};

/// The scans of a saved map that is to be continued; none without a path.
/// \throws std::runtime_error naming the file, as ram_slam::loadWorldMap() or if it has no scans
std::vector<ram_slam::PlacedScan> loadScans(const std::string& initial_map);

}  // namespace ram_slam_ros
