// SPDX-License-Identifier: BSD-3-Clause
#include "map_to_odom_publisher.hpp"

#include <algorithm>
#include <chrono>

#include <ros/ros.h>

#include "ram_slam/ros/conversions.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
MapToOdomPublisher::MapToOdomPublisher(const ram_slam::Frames& frames,
                                       const ram_slam::MapToOdomParameters& parameters,
                                       double ahead_s,
                                       const tf2_ros::Buffer& buffer)
    : frames_(frames),
      parameters_(parameters),
      ahead_ns_(static_cast<std::int64_t>(ahead_s * 1e9)),
      buffer_(buffer) {
  thread_ = std::thread([this] { run(); });
}

MapToOdomPublisher::~MapToOdomPublisher() {
  stop_ = true;
  thread_.join();
}

void MapToOdomPublisher::correct(std::int64_t stamp_ns, const ram_slam::Pose2& map_from_base) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pending_ = Correction{stamp_ns, map_from_base};
  last_data_ns_ = stamp_ns;
}

std::optional<ram_slam::Pose2> MapToOdomPublisher::odometryBetween(std::int64_t from_ns,
                                                                   std::int64_t to_ns) const {
  if (from_ns <= 0) return std::nullopt;
  try {
    const auto poseAt = [this](std::int64_t stamp_ns) {
      return toPose2(
          buffer_.lookupTransform(frames_.odom, frames_.base, toTime(stamp_ns)).transform);
    };
    const ram_slam::Pose2 moved = poseAt(from_ns).inverse() * poseAt(to_ns);
    const double most_m =
        parameters_.maximum_speed_mps * 1e-9 * static_cast<double>(to_ns - from_ns);
    if (moved.translation().norm() > most_m) return std::nullopt;
    return moved;
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

void MapToOdomPublisher::reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  pending_.reset();
  map_from_odom_.reset();
  last_data_ns_ = last_sent_ns_ = 0;
}

void MapToOdomPublisher::run() {
  while (!stop_ && ros::ok()) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      applyCorrection();
      publishIfDue();
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(parameters_.tick_s));
  }
}

void MapToOdomPublisher::applyCorrection() {
  if (!pending_) return;
  try {
    const auto odom_from_base =
        buffer_.lookupTransform(frames_.odom, frames_.base, toTime(pending_->stamp_ns));
    map_from_odom_ = pending_->map_from_base * toPose2(odom_from_base.transform).inverse();
    pending_.reset();
    changed_ = true;
  } catch (const std::exception& error) {
    ROS_DEBUG_STREAM_THROTTLE(kLogPeriodS, "Waiting for odometry in tf: " << error.what());
  }
}

void MapToOdomPublisher::publishIfDue() {
  const std::int64_t clock_ns = toNanoseconds(ros::Time::now());
  const auto passed = clock_guard_.add(clock_ns, clock_ns, clock_drops_);
  if (passed.is_set_back) last_sent_ns_ = 0;
  if (clock_drops_.total() > 0) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "The clock leapt and came back: "
                                              << clock_drops_.newest().detail
                                              << "; is there a second publisher of /clock?");
    clock_drops_ = {};
  }
  if (!passed.messages.empty()) publish(passed.messages.back());
}

void MapToOdomPublisher::publish(std::int64_t now_ns) {
  if (!map_from_odom_) return;
  const std::int64_t stamp_ns = std::max(now_ns, last_data_ns_) + ahead_ns_;
  const auto period_ns = static_cast<std::int64_t>(parameters_.period_s * 1e9);
  if (stamp_ns <= last_sent_ns_ || (!changed_ && stamp_ns < last_sent_ns_ + period_ns)) return;
  geometry_msgs::TransformStamped message;
  message.header.stamp = toTime(stamp_ns);
  message.header.frame_id = frames_.map;
  message.child_frame_id = frames_.odom;
  message.transform = toTransformMessage(*map_from_odom_);
  broadcaster_.sendTransform(message);
  last_sent_ns_ = stamp_ns;
  changed_ = false;
}

}  // namespace ram_slam_ros
