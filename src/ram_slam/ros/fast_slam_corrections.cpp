// SPDX-License-Identifier: BSD-3-Clause
// What the node takes from the smoother.
#include <utility>

#include <nav_msgs/Path.h>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "fast_slam_node.hpp"
#include "node_defaults.hpp"

namespace ram_slam_ros {
namespace {

void logCorrection(const ram_slam::Pose2& correction) {
  ROS_WARN_STREAM("The smoothed trajectory moves the pose by "
                  << correction.translation().norm() << " m and turns it by " << correction.yaw_rad
                  << " rad, and the map with it");
}

}  // namespace

void FastSlamNode::onSmoothedTrajectory(const nav_msgs::Path& message) {
  try {
    ram_slam::Trajectory trajectory = toTrajectory(message);
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    smoothed_ = std::move(trajectory);
    queue_changed_.notify_one();
  } catch (const std::exception& error) {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    queue_drops_.add(ram_slam::DropReason::kInvalidTrajectory, toNanoseconds(message.header.stamp),
                     error.what());
  }
}

void FastSlamNode::onMapPose(const geometry_msgs::PoseStamped& message) {
  try {
    const ram_slam::Pose2 pose = toPose2(message.pose);
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    if (map_poses_.size() >= static_cast<std::size_t>(node_parameters_.waiting.queue_size)) {
      queue_drops_.add(ram_slam::DropReason::kQueueFull, map_poses_.front().stamp_ns, "map_pose");
      map_poses_.pop_front();
    }
    map_poses_.push_back({toNanoseconds(message.header.stamp), pose});
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Rejected a pose on map_pose: " << error.what());
  }
}

void FastSlamNode::followMapPoses() {
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    for (const ram_slam::StampedPose2& pose : map_poses_) stage_.addMapPose(pose);
    map_poses_.clear();
  }
  stage_.followMapPoses();
}

void FastSlamNode::followCorrection() {
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    if (smoothed_) stage_.addCorrection(std::move(*smoothed_));
    smoothed_.reset();
  }
  const ram_slam::Pose2 before = stage_.estimator().estimate().pose;
  const auto corrected = stage_.followCorrection();
  if (!corrected) return;
  const ram_slam::Pose2 correction = before.inverse() * stage_.estimator().estimate().pose;
  if (node_parameters_.logged_correction.isReachedBy(correction)) logCorrection(correction);
  corrected_trajectory_.publish(toPath(*corrected, node_parameters_.frames.map));
  last_output_ns_ = 0;
}

}  // namespace ram_slam_ros
