// SPDX-License-Identifier: BSD-3-Clause
#include "scan_odometry_queue.hpp"

#include <stdexcept>
#include <utility>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/mounting.hpp"

namespace ram_slam_ros {
namespace {

constexpr std::size_t kMaxWaiting = 1000;
constexpr std::size_t kMaxOdometry = 2000;
constexpr double kMaxWaitS = 1.0;
constexpr std::int64_t kTimeJumpNs = 1000000000;
constexpr double kWarnPeriodS = 5.0;

}  // namespace

ScanOdometryQueue::ScanOdometryQueue(std::string base_frame, bool needs_odometry)
    : base_frame_(std::move(base_frame)), needs_odometry_(needs_odometry) {}

void ScanOdometryQueue::addScan(const sensor_msgs::LaserScan& message) {
  scans_.push_back({toLaserScan(message), message.header.frame_id, ros::SteadyTime::now()});
  if (scans_.size() > kMaxWaiting) scans_.pop_front();
}

void ScanOdometryQueue::addOdometry(const nav_msgs::Odometry& message) {
  const std::int64_t stamp_ns = toNanoseconds(message.header.stamp);
  const ram_slam::Pose2 odom_from_base = toPose2(message.pose.pose);
  if (!odometry_.empty() && stamp_ns <= odometry_.back().stamp_ns) {
    if (odometry_.back().stamp_ns - stamp_ns < kTimeJumpNs) {
      throw std::invalid_argument("odometry not later than the last");
    }
    odometry_.clear();  // the clock was set back
    scans_.clear();
  }
  odometry_.push_back({stamp_ns, odom_from_base});
  if (odometry_.size() > kMaxOdometry) odometry_.pop_front();
}

std::optional<ScanWithOdometry> ScanOdometryQueue::next() {
  while (!scans_.empty()) {
    std::optional<ScanWithOdometry> ready = complete(scans_.front());
    const std::int64_t stamp_ns = scans_.front().scan.stamp_ns;
    const bool waited_long = (ros::SteadyTime::now() - scans_.front().since).toSec() > kMaxWaitS;
    // Odometry comes in order: what is before its beginning never gets any.
    const bool hopeless = needs_odometry_ && !odometry_.empty() &&
                          stamp_ns + stamp_offset_ns_ < odometry_.front().stamp_ns;
    if (!ready && !waited_long && !hopeless) return std::nullopt;
    scans_.pop_front();
    if (ready) return ready;
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "dropped a scan: no odometry or no transform to "
                                               << base_frame_ << " for it");
  }
  return std::nullopt;
}

std::optional<ScanWithOdometry> ScanOdometryQueue::complete(const Waiting& waiting) const {
  const ros::Time stamp = toTime(waiting.scan.stamp_ns);
  if (!transforms_.canTransform(base_frame_, waiting.frame, stamp)) return std::nullopt;
  ScanWithOdometry complete;
  if (needs_odometry_) {
    complete.odom_from_base =
        ram_slam::odometryAt(odometry_, waiting.scan.stamp_ns + stamp_offset_ns_);
    if (!complete.odom_from_base) return std::nullopt;
  }
  const Mounting mounting =
      toMounting(transforms_.lookupTransform(base_frame_, waiting.frame, stamp).transform);
  complete.scan = mounting.upside_down ? ram_slam::mirrored(waiting.scan) : waiting.scan;
  complete.base_from_laser = mounting.base_from_sensor;
  return complete;
}

}  // namespace ram_slam_ros
