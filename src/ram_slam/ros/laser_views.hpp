// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>

#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam_ros {

/// The recent scans, as what the lidar could have seen. Any thread may call.
class LaserViews {
public:
  /// \param buffer  where the lidar is mounted; outlives this
  /// \param most  scans that are kept
  LaserViews(std::string base_frame, const tf2_ros::Buffer& buffer, std::size_t most);

  void add(const sensor_msgs::LaserScanConstPtr& scan);
  /// Null if there is no scan of that stamp, or none of use.
  std::shared_ptr<const ram_slam::LaserView> at(std::int64_t stamp_ns);

private:
  std::string base_frame_;
  const tf2_ros::Buffer& buffer_;
  std::size_t most_;
  std::mutex mutex_;
  std::deque<sensor_msgs::LaserScanConstPtr> scans_;
};

}  // namespace ram_slam_ros
