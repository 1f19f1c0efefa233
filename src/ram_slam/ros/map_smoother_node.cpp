// SPDX-License-Identifier: BSD-3-Clause
#include "map_smoother_node.hpp"

#include <exception>
#include <utility>

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/SmoothingStatus.h>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
MapSmootherNode::MapSmootherNode(ram_parameters::ParameterReader& reader)
    : parameters_(ram_slam::readMapSmootherParameters(reader)),
      stage_(parameters_, matchers_.matchers(), loadScans(parameters_.initial_map)),
      scans_(parameters_.base_frame, transforms_),
      diagnostics_(ram_slam::Link::kPose, "smoothing", [this] { return report(); }) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  publisher_ = node_.advertise<nav_msgs::Path>("smoothed_trajectory", 1, kLatched);
  map_pose_publisher_ = node_.advertise<geometry_msgs::PoseStamped>("map_pose", 100);
  status_publisher_ = node_.advertise<ram_slam_msgs::SmoothingStatus>("smoothing_status", 100);
  scan_subscriber_ = node_.subscribe("scan", kQueueSize, &MapSmootherNode::onScan, this, hints);
  scans_.followCalibration(node_);
  odometry_subscriber_ =
      node_.subscribe("odom", kQueueSize, &MapSmootherNode::onOdometry, this, hints);
  features_subscriber_ =
      node_.subscribe("features", kQueueSize, &MapSmootherNode::onFeatures, this, hints);
  tracking_subscriber_ = node_.subscribe("tracking", 10, &MapSmootherNode::onTracking, this, hints);
  optimize_service_ =
      private_node_.advertiseService("optimize", &MapSmootherNode::onOptimize, this);
  undo_service_ =
      private_node_.advertiseService("undo_closure", &MapSmootherNode::onUndoClosure, this);
  scan_input_ = &diagnostics_.watch<sensor_msgs::LaserScan>(scan_subscriber_, scanInput());
  odometry_input_ =
      &diagnostics_.watch<nav_msgs::Odometry>(odometry_subscriber_, refinedOdometryInput());
  diagnostics_.needMount(transforms_, parameters_.base_frame);
  // In a loaded map it waits for the robot to be found.
  if (parameters_.initial_map.empty()) diagnostics_.setOutput(status_publisher_.getTopic());
  ROS_INFO_STREAM("Smoothing " << odometry_subscriber_.getTopic() << " by "
                               << scan_subscriber_.getTopic() << " into " << publisher_.getTopic());
}

NodeDiagnostics::Report MapSmootherNode::report() const {
  NodeDiagnostics::Report report;
  report.drops = stage_.drops();
  report.values = {{"key scans", static_cast<double>(stage_.smoother().keyScans().size())},
                   {"loop closures", static_cast<double>(stage_.smoother().closures().size())},
                   {"corrections published", correction_count_}};
  report.messages = scans_.messages();
  return report;
}

void MapSmootherNode::onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event) {
  diagnostics_.arrived(*scan_input_, event);
  const std::uint64_t drops_before = stage_.drops().total();
  scans_.add(event, stage_.drops());
  diagnostics_.refusedIfDropped(*scan_input_, stage_.drops(), drops_before);
  processWaiting();
}

void MapSmootherNode::onOdometry(const ros::MessageEvent<const nav_msgs::Odometry>& event) {
  diagnostics_.arrived(*odometry_input_, event);
  const nav_msgs::Odometry& message = *event.getMessage();
  const std::uint64_t drops_before = stage_.drops().total();
  const std::int64_t stamp_ns = toNanoseconds(message.header.stamp);
  try {
    const ram_slam::StampedPose2 reading{stamp_ns, toPose2(message.pose.pose)};
    for (const auto& passed : odometry_guard_.add(stamp_ns, reading, stage_.drops()).messages)
      stage_.addOdometry(passed);
  } catch (const std::exception& error) {
    stage_.drops().add(ram_slam::DropReason::kInvalidOdometry, stamp_ns, error.what());
  }
  diagnostics_.refusedIfDropped(*odometry_input_, stage_.drops(), drops_before);
  processWaiting();
}

void MapSmootherNode::onFeatures(const ram_slam_msgs::FeatureList& message) {
  try {
    stage_.addFeatures(toFeatureList(message, parameters_.base_frame).list);
  } catch (const std::exception& error) {
    stage_.drops().add(ram_slam::DropReason::kInvalidFeatures, toNanoseconds(message.header.stamp),
                       error.what());
  }
}

void MapSmootherNode::onTracking(const ram_slam_msgs::Tracking& message) {
  try {
    stage_.set(toTracking(message, parameters_.map_frame));
  } catch (const std::exception& error) {
    ROS_WARN_STREAM("Refused a message on " << tracking_subscriber_.getTopic() << ": "
                                            << error.what());
  }
}

void MapSmootherNode::processWaiting() {
  while (auto scan = scans_.next(stage_.drops())) stage_.add(std::move(*scan));
  while (const auto step = stage_.next()) {
    if (stage_.resetCount() != reset_count_) {
      reset_count_ = stage_.resetCount();
      logged_closures_ = 0;
      ROS_WARN_STREAM("The stamps on " << scan_subscriber_.getTopic()
                                       << " were set back: smoothing starts again");
    }
    logNewClosures();
    if (step->correction) publish(*step->correction);
    if (step->map_from_base) publishMapPose(step->stamp_ns, *step->map_from_base);
    publishStatus(step->stamp_ns);
  }
  drop_log_.log(stage_.drops(),
                scan_subscriber_.getTopic() + ", " + odometry_subscriber_.getTopic());
}

void MapSmootherNode::logNewClosures() {
  const auto& closures = stage_.smoother().closures();
  for (; logged_closures_ < closures.size(); ++logged_closures_) {
    const ram_slam::LoopClosure& closure = closures[logged_closures_];
    ROS_INFO_STREAM("Loop closure " << logged_closures_ << ": at " << toTime(closure.new_stamp_ns)
                                    << " the robot was at the place of "
                                    << toTime(closure.old_stamp_ns) << ", correction "
                                    << closure.correction_m << " m, score " << closure.score
                                    << ", inliers " << closure.inlier_ratio
                                    << (closure.is_ambiguous ? ", open along a corridor" : ""));
  }
}

void MapSmootherNode::publish(const ram_slam::Trajectory& smoothed) {
  ++correction_count_;
  const auto most = static_cast<std::size_t>(parameters_.max_published_poses);
  publisher_.publish(toPath(ram_slam::withAtMost(smoothed, most), parameters_.map_frame));
}

void MapSmootherNode::publishMapPose(std::int64_t stamp_ns, const ram_slam::Pose2& map_from_base) {
  geometry_msgs::PoseStamped message;
  message.header.stamp = toTime(stamp_ns);
  message.header.frame_id = parameters_.map_frame;
  message.pose = toPoseMessage(map_from_base);
  map_pose_publisher_.publish(message);
}

void MapSmootherNode::publishStatus(std::int64_t stamp_ns) {
  ram_slam_msgs::SmoothingStatus status;
  status.header.stamp = toTime(stamp_ns);
  status.header.frame_id = parameters_.map_frame;
  status.key_scan_count = static_cast<std::uint32_t>(stage_.smoother().keyScans().size());
  status.closure_count = static_cast<std::uint32_t>(stage_.smoother().closures().size());
  status.correction_count = correction_count_;
  status_publisher_.publish(status);
  diagnostics_.answered(stamp_ns);
}

bool MapSmootherNode::onOptimize(std_srvs::Trigger::Request& /*request*/,
                                 std_srvs::Trigger::Response& response) {
  try {
    publish(stage_.optimize());
    logNewClosures();
    response.success = true;
    response.message = std::to_string(stage_.smoother().keyScans().size()) + " key scans, " +
                       std::to_string(stage_.smoother().closures().size()) + " closures";
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

bool MapSmootherNode::onUndoClosure(std_srvs::Trigger::Request& /*request*/,
                                    std_srvs::Trigger::Response& response) {
  try {
    const auto undone = stage_.undoClosure();
    response.success = undone.has_value();
    response.message =
        undone ? "refused closure " + std::to_string(*undone) : "there is no accepted closure";
    if (undone) publish(stage_.optimize());
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

}  // namespace ram_slam_ros
