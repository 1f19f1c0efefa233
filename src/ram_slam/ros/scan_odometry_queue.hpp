// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam_ros {

/// A scan with the laser's mount and the odometry at its stamp.
struct ScanWithOdometry {
  ram_slam::LaserScan scan;
  ram_slam::Pose2 base_from_laser;
  std::optional<ram_slam::Pose2> odom_from_base;
};

/// Holds scans back until the odometry reaches their stamps.
class ScanOdometryQueue {
public:
  /// \param needs_odometry  false: scans go through at once, without odometry
  ScanOdometryQueue(std::string base_frame, bool needs_odometry);

  /// \throws std::invalid_argument for a message that cannot be used
  void addScan(const sensor_msgs::LaserScan& message);
  void addOdometry(const nav_msgs::Odometry& message);

  /// From now on the odometry is taken so much later than the scan's stamp.
  void setStampOffset(std::int64_t offset_ns) { stamp_offset_ns_ = offset_ns; }

  /// The next scan whose odometry and mount are known; none if there is none yet. Scans from
  /// before the first odometry, and those that waited for longer than a second, are dropped with
  /// a warning.
  std::optional<ScanWithOdometry> next();

private:
  struct Waiting {
    ram_slam::LaserScan scan;
    std::string frame;
    ros::SteadyTime since;
  };

  std::optional<ScanWithOdometry> complete(const Waiting& waiting) const;

  std::string base_frame_;
  bool needs_odometry_;
  std::int64_t stamp_offset_ns_ = 0;
  std::deque<Waiting> scans_;
  std::deque<ram_slam::StampedPose2> odometry_;
  // Longer than tf's usual: a recording may be played many times faster than real time.
  tf2_ros::Buffer transforms_{ros::Duration(60.0)};
  tf2_ros::TransformListener listener_{transforms_};
};

}  // namespace ram_slam_ros
