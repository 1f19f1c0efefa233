// SPDX-License-Identifier: BSD-3-Clause
#include "mounted_scans.hpp"

#include <exception>
#include <utility>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/mounting.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
namespace {

constexpr double kMaxWaitS = 1.0;  // a static transform arrives within milliseconds

}  // namespace

void MountedScans::add(const sensor_msgs::LaserScan& message, ram_slam::DropCounter& drops) {
  const std::int64_t stamp_ns = toNanoseconds(message.header.stamp);
  try {
    waiting_.push_back({toLaserScan(message), message.header.frame_id, ros::SteadyTime::now()});
  } catch (const std::exception& error) {
    drops.add(ram_slam::DropReason::kInvalidScan, stamp_ns, error.what());
    return;
  }
  if (waiting_.size() <= kQueueSize) return;
  drops.add(ram_slam::DropReason::kQueueFull, waiting_.front().scan.stamp_ns, "scan");
  waiting_.pop_front();
}

std::optional<ram_slam::MountedScan> MountedScans::next(ram_slam::DropCounter& drops) {
  while (!waiting_.empty()) {
    Waiting& first = waiting_.front();
    const ros::Time stamp = toTime(first.scan.stamp_ns);
    std::string problem;
    const bool is_known = transforms_.canTransform(base_frame_, first.frame, stamp, &problem);
    const double waited_s = (ros::SteadyTime::now() - first.since).toSec();
    if (!is_known && waited_s <= kMaxWaitS) return std::nullopt;
    Waiting scan = std::move(first);
    waiting_.pop_front();
    try {
      if (!is_known) {
        drops.add(ram_slam::DropReason::kNoMount, scan.scan.stamp_ns, problem);
        continue;
      }
      const Mounting mounting =
          toMounting(transforms_.lookupTransform(base_frame_, scan.frame, stamp).transform);
      if (mounting.upside_down) scan.scan = ram_slam::mirrored(std::move(scan.scan));
      return ram_slam::MountedScan{std::move(scan.scan), mounting.base_from_sensor};
    } catch (const std::exception& error) {
      drops.add(ram_slam::DropReason::kNoMount, scan.scan.stamp_ns, error.what());
    }
  }
  return std::nullopt;
}

}  // namespace ram_slam_ros
