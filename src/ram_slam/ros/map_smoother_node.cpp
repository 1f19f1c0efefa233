// SPDX-License-Identifier: BSD-3-Clause
#include "map_smoother_node.hpp"

#include <exception>

#include <nav_msgs/Path.h>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

namespace ram_slam_ros {
namespace {

constexpr std::uint32_t kQueueSize = 1000;  // scans go on while it optimizes
constexpr double kWarnPeriodS = 5.0;

}  // namespace

MapSmootherNode::MapSmootherNode(ram_parameters::ParameterReader& reader)
    : parameters_(ram_slam::readMapSmootherParameters(reader)),
      smoother_(parameters_, matchers_.matchers()),
      queue_(parameters_.base_frame, true) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  publisher_ = node_.advertise<nav_msgs::Path>("smoothed_trajectory", 1, true);
  scan_subscriber_ = node_.subscribe("scan", kQueueSize, &MapSmootherNode::onScan, this, hints);
  odometry_subscriber_ =
      node_.subscribe("odom", kQueueSize, &MapSmootherNode::onOdometry, this, hints);
  features_subscriber_ =
      node_.subscribe("features", kQueueSize, &MapSmootherNode::onFeatures, this, hints);
  optimize_service_ =
      private_node_.advertiseService("optimize", &MapSmootherNode::onOptimize, this);
  undo_service_ =
      private_node_.advertiseService("undo_closure", &MapSmootherNode::onUndoClosure, this);
  ROS_INFO_STREAM("smoothing " << odometry_subscriber_.getTopic() << " by "
                               << scan_subscriber_.getTopic() << " into " << publisher_.getTopic());
}

void MapSmootherNode::onScan(const sensor_msgs::LaserScan& message) {
  try {
    queue_.addScan(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "rejected a scan: " << error.what());
  }
  processWaiting();
}

void MapSmootherNode::onOdometry(const nav_msgs::Odometry& message) {
  try {
    queue_.addOdometry(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "rejected odometry: " << error.what());
  }
  processWaiting();
}

void MapSmootherNode::onFeatures(const ram_slam_msgs::FeatureList& message) {
  try {
    smoother_.addFeatures(toFeatureList(message, parameters_.base_frame).list);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "rejected features: " << error.what());
  }
}

void MapSmootherNode::processWaiting() {
  while (true) {
    try {
      const auto next = queue_.next();
      if (!next) return;
      if (next->scan.stamp_ns + 1000000000 < last_stamp_ns_) {
        ROS_WARN("time jumped back: smoothing starts anew");
        smoother_ = ram_slam::MapSmoother(parameters_, matchers_.matchers());
        logged_closures_ = 0;
      }
      smoother_.addScan(next->scan, next->base_from_laser, *next->odom_from_base);
      last_stamp_ns_ = next->scan.stamp_ns;
      smoother_.optimizeIfDue();
      logNewClosures();
      if (smoother_.hasCorrection()) publish();
    } catch (const std::exception& error) {
      ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "skipped a scan: " << error.what());
    }
  }
}

void MapSmootherNode::logNewClosures() {
  for (; logged_closures_ < smoother_.closures().size(); ++logged_closures_) {
    const ram_slam::LoopClosure& closure = smoother_.closures()[logged_closures_];
    ROS_INFO_STREAM("closure " << logged_closures_ << ": the place of "
                               << toTime(closure.old_stamp_ns) << " again at "
                               << toTime(closure.new_stamp_ns) << ", correction "
                               << closure.correction_m << " m, score " << closure.score
                               << ", inliers " << closure.inlier_ratio
                               << (closure.is_ambiguous ? ", open along a corridor" : ""));
  }
}

void MapSmootherNode::optimize() {
  smoother_.optimize();
  logNewClosures();
  publish();
}

void MapSmootherNode::publish() {
  publisher_.publish(toPath(smoother_.takeCorrection(), parameters_.map_frame));
}

bool MapSmootherNode::onOptimize(std_srvs::Trigger::Request& /*request*/,
                                 std_srvs::Trigger::Response& response) {
  try {
    optimize();
    response.success = true;
    response.message = std::to_string(smoother_.keyScans().size()) + " key scans, " +
                       std::to_string(smoother_.closures().size()) + " closures";
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

bool MapSmootherNode::onUndoClosure(std_srvs::Trigger::Request& /*request*/,
                                    std_srvs::Trigger::Response& response) {
  for (std::size_t i = smoother_.closures().size(); i-- > 0;) {
    if (smoother_.closures()[i].state != ram_slam::ClosureState::kAccepted) continue;
    try {
      smoother_.refuseClosure(i);
      optimize();
      response.success = true;
      response.message = "took back closure " + std::to_string(i);
    } catch (const std::exception& error) {
      response.message = error.what();
    }
    return true;
  }
  response.message = "there is no accepted closure";
  return true;
}

}  // namespace ram_slam_ros
