// SPDX-License-Identifier: BSD-3-Clause
#include "mounted_scans.hpp"

#include <exception>
#include <stdexcept>
#include <utility>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/mounting.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"
#include "ram_slam/world_map/map_folder.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
namespace {

constexpr double kMaxWaitS = 1.0;  // a static transform arrives within milliseconds

}  // namespace

void MountedScans::followCalibration(ros::NodeHandle& node) {
  calibration_ = node.subscribe("lidar_calibration", 1, &MountedScans::onCalibration, this,
                                ros::TransportHints().tcpNoDelay());
}

void MountedScans::onCalibration(const ram_slam_msgs::LidarCalibration& message) {
  try {
    added_mirror_turn_s_ = toAddedMirrorTurn_s(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, calibration_.getTopic() << " ignored: " << error.what());
  }
}

bool MountedScans::add(const ros::MessageEvent<const sensor_msgs::LaserScan>& event,
                       ram_slam::DropCounter& drops) {
  const sensor_msgs::LaserScan& message = *event.getMessage();
  messages_.add(event.getPublisherName(), message.header.seq);
  const std::int64_t stamp_ns = toNanoseconds(message.header.stamp);
  ram_slam::PassedMessages<Waiting> passed;
  try {
    passed = guard_.add(
        stamp_ns, {toLaserScan(message), message.header.frame_id, ros::SteadyTime::now()}, drops);
  } catch (const std::exception& error) {
    drops.add(ram_slam::DropReason::kInvalidScan, stamp_ns, error.what());
  }
  if (passed.is_set_back) waiting_.clear();
  for (Waiting& scan : passed.messages) {
    scan.since = ros::SteadyTime::now();
    waiting_.push_back(std::move(scan));
    if (waiting_.size() <= kQueueSize) continue;
    drops.add(ram_slam::DropReason::kQueueFull, waiting_.front().scan.stamp_ns, "scan");
    waiting_.pop_front();
  }
  return passed.is_set_back;
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
      return ram_slam::MountedScan{corrected(std::move(scan.scan), added_mirror_turn_s_),
                                   mounting.base_from_sensor};
    } catch (const std::exception& error) {
      drops.add(ram_slam::DropReason::kNoMount, scan.scan.stamp_ns, error.what());
    }
  }
  return std::nullopt;
}

std::vector<ram_slam::PlacedScan> loadScans(const std::string& initial_map) {
  if (initial_map.empty()) return {};
  std::vector<ram_slam::PlacedScan> scans =
      ram_slam::loadWorldMap(ram_slam::expandHome(initial_map)).scans();
  if (scans.empty()) throw std::runtime_error(initial_map + ": it holds no scans to continue from");
  ROS_INFO_STREAM("Continuing the map of " << scans.size() << " scans in " << initial_map
                                           << " once the robot is found in it");
  return scans;
}

}  // namespace ram_slam_ros
