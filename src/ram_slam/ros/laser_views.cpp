// SPDX-License-Identifier: BSD-3-Clause
#include "laser_views.hpp"

#include <algorithm>
#include <utility>

#include <ros/console.h>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/mounting.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
LaserViews::LaserViews(std::string base_frame, const tf2_ros::Buffer& buffer, std::size_t most)
    : base_frame_(std::move(base_frame)), buffer_(buffer), most_(most) {}

void LaserViews::add(const sensor_msgs::LaserScanConstPtr& scan) {
  const std::lock_guard<std::mutex> lock(mutex_);
  scans_.push_back(scan);
  if (scans_.size() > most_) scans_.pop_front();
}

std::shared_ptr<const ram_slam::LaserView> LaserViews::at(std::int64_t stamp_ns) {
  sensor_msgs::LaserScanConstPtr scan;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto place = std::find_if(scans_.begin(), scans_.end(), [stamp_ns](const auto& other) {
      return toNanoseconds(other->header.stamp) == stamp_ns;
    });
    if (place == scans_.end()) return nullptr;
    scan = *place;
  }
  try {
    const auto transform =
        buffer_.lookupTransform(base_frame_, scan->header.frame_id, ros::Time(0));
    const Mounting mounting = toMounting(transform.transform);
    const ram_slam::LaserScan readings = toLaserScan(*scan);
    return std::make_shared<const ram_slam::LaserView>(
        mounting.upside_down ? mirrored(readings) : readings, mounting.base_from_sensor);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS,
                             "Landmarks that should be visible are not checked: " << error.what());
    return nullptr;
  }
}

}  // namespace ram_slam_ros
