// SPDX-License-Identifier: BSD-3-Clause
#include "laser_odometry_node.hpp"

#include <exception>

#include "ram_slam/ros/conversions.hpp"

namespace ram_slam_ros {
namespace {

constexpr std::uint32_t kQueueSize = 200;
constexpr double kWarnPeriodS = 5.0;

}  // namespace

LaserOdometryNode::LaserOdometryNode(ram_parameters::ParameterReader& reader)
    : parameters_(ram_slam::readLaserOdometryParameters(reader)),
      odometry_(parameters_),
      stamp_offset_(parameters_.max_stamp_offset_s),
      queue_(parameters_.base_frame, parameters_.use_wheels) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  publisher_ = node_.advertise<nav_msgs::Odometry>("laser_odom", kQueueSize);
  scan_subscriber_ = node_.subscribe("scan", kQueueSize, &LaserOdometryNode::onScan, this, hints);
  if (parameters_.use_wheels) {
    odometry_subscriber_ =
        node_.subscribe("odom", kQueueSize, &LaserOdometryNode::onOdometry, this, hints);
  }
  ROS_INFO_STREAM(
      "refining " << (parameters_.use_wheels ? odometry_subscriber_.getTopic() : "no wheels")
                  << " by " << scan_subscriber_.getTopic() << " into " << publisher_.getTopic());
}

void LaserOdometryNode::onScan(const sensor_msgs::LaserScan& message) {
  try {
    queue_.addScan(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "rejected a scan: " << error.what());
  }
  processWaiting();
}

void LaserOdometryNode::onOdometry(const nav_msgs::Odometry& message) {
  try {
    queue_.addOdometry(message);
    stamp_offset_.addWheels({toNanoseconds(message.header.stamp), toPose2(message.pose.pose)});
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "rejected odometry: " << error.what());
  }
  processWaiting();
}

void LaserOdometryNode::processWaiting() {
  while (true) {
    try {
      const auto next = queue_.next();
      if (!next) return;
      if (next->scan.stamp_ns + 1000000000 < last_stamp_ns_) {
        ROS_WARN("time jumped back: laser odometry starts anew");
        odometry_ = ram_slam::LaserOdometry(parameters_);
        stamp_offset_ = ram_slam::StampOffset(parameters_.max_stamp_offset_s);
      }
      const ram_slam::LaserOdometryEstimate estimate =
          odometry_.update(next->scan, next->base_from_laser, next->odom_from_base);
      stamp_offset_.addScan({estimate.stamp_ns, estimate.odom_from_base.pose});
      queue_.setStampOffset(stamp_offset_.offset_ns());
      publish(estimate);
      last_stamp_ns_ = next->scan.stamp_ns;
    } catch (const std::exception& error) {
      ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "skipped a scan: " << error.what());
    }
  }
}

void LaserOdometryNode::publish(const ram_slam::LaserOdometryEstimate& estimate) {
  if (estimate.wheels_slipped)
    ROS_WARN_THROTTLE(kWarnPeriodS, "the wheels slip: scans contradict them");
  if (estimate.wheels_stuck)
    ROS_ERROR_THROTTLE(kWarnPeriodS, "odometry stuck: the robot moves, the wheels stand still");
  nav_msgs::Odometry message;
  message.header.stamp = toTime(estimate.stamp_ns);
  message.header.frame_id = parameters_.odom_frame;
  message.child_frame_id = parameters_.base_frame;
  message.pose = toPoseWithCovarianceMessage(estimate.odom_from_base);
  publisher_.publish(message);
}

}  // namespace ram_slam_ros
