// SPDX-License-Identifier: BSD-3-Clause
#include "laser_odometry_node.hpp"

#include <exception>

#include "ram_slam/ros/conversions.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {

LaserOdometryNode::LaserOdometryNode(ram_parameters::ParameterReader& reader)
    : parameters_(ram_slam::readLaserOdometryParameters(reader)),
      stage_(parameters_),
      scans_(parameters_.base_frame, transforms_),
      publisher_(node_.advertise<nav_msgs::Odometry>("laser_odom", kQueueSize)),
      calibration_publisher_(
          node_.advertise<ram_slam_msgs::LidarCalibration>("lidar_calibration", 1, kLatched)),
      scan_subscriber_(node_.subscribe("scan",
                                       kQueueSize,
                                       &LaserOdometryNode::onScan,
                                       this,
                                       ros::TransportHints().tcpNoDelay())),
      diagnostics_(ram_slam::Link::kOdometry, "odometry", [this] { return report(); }),
      scan_input_(diagnostics_.watch<sensor_msgs::LaserScan>(scan_subscriber_, scanInput())) {
  if (parameters_.use_wheels) {
    odometry_subscriber_ = node_.subscribe("odom", kQueueSize, &LaserOdometryNode::onOdometry, this,
                                           ros::TransportHints().tcpNoDelay());
    odometry_input_ =
        &diagnostics_.watch<nav_msgs::Odometry>(odometry_subscriber_, odometryInput());
  }
  diagnostics_.needMount(transforms_, parameters_.base_frame);
  diagnostics_.setOutput(publisher_.getTopic());
  // Nodes that ran before this one started may correct scans by what an earlier run has learned.
  publishCalibration();
  ROS_INFO_STREAM(
      "Refining " << (parameters_.use_wheels ? odometry_subscriber_.getTopic() : "no odometry")
                  << " by " << scan_subscriber_.getTopic() << " into " << publisher_.getTopic());
}

NodeDiagnostics::Report LaserOdometryNode::report() const {
  NodeDiagnostics::Report report;
  report.drops = stage_.drops();
  report.values = {{"scans that contradict the wheels", static_cast<double>(stage_.slipCount())},
                   {"scans without odometry", static_cast<double>(stage_.withoutWheelsCount())},
                   {"stamp offset [s]", 1e-9 * static_cast<double>(stage_.stampOffset_ns())},
                   {"lidar: correction of the time of a mirror turn [s]", added_mirror_turn_s_}};
  report.messages = scans_.messages();
  if (stage_.isMirrored()) {
    report.causes.push_back(
        {ram_slam::Link::kTf, ram_slam::Severity::kError, "upside down",
         "scans and wheels turn against each other: is the lidar mounted upside down, and upright "
         "in tf, or the other way round? Turn its frame by 180 degrees about x in the URDF; else "
         "the odometry turns the wrong way"});
  }
  if (!stuck_.isZero() && (ros::SteadyTime::now() - stuck_).toSec() < kLogPeriodS) {
    report.causes.push_back({ram_slam::Link::kOdometry, ram_slam::Severity::kError,
                             "odometry stuck",
                             "odometry stuck: the scans show motion, the odometry none; check the "
                             "encoders"});
  }
  return report;
}

void LaserOdometryNode::onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event) {
  diagnostics_.arrived(scan_input_, event);
  const std::uint64_t drops_before = stage_.drops().total();
  scans_.add(event, stage_.drops());
  diagnostics_.refusedIfDropped(scan_input_, stage_.drops(), drops_before);
  processWaiting();
}

void LaserOdometryNode::onOdometry(const ros::MessageEvent<const nav_msgs::Odometry>& event) {
  diagnostics_.arrived(*odometry_input_, event);
  const nav_msgs::Odometry& message = *event.getMessage();
  const std::int64_t stamp_ns = toNanoseconds(message.header.stamp);
  const std::uint64_t drops_before = stage_.drops().total();
  try {
    requireFrames(message, parameters_.odom_frame, parameters_.base_frame);
    const ram_slam::StampedPose2 reading{stamp_ns, toPose2(message.pose.pose)};
    for (const auto& passed : odometry_guard_.add(stamp_ns, reading, stage_.drops()).messages)
      stage_.addWheels(passed);
  } catch (const std::exception& error) {
    stage_.drops().add(ram_slam::DropReason::kInvalidOdometry, stamp_ns, error.what());
  }
  diagnostics_.refusedIfDropped(*odometry_input_, stage_.drops(), drops_before);
  processWaiting();
}

void LaserOdometryNode::processWaiting() {
  while (auto scan = scans_.next(stage_.drops())) stage_.add(std::move(*scan));
  while (const auto step = stage_.next()) {
    for (const ram_slam::StampedPose2& pose : step->between)
      publish(pose.stamp_ns, {pose.pose, step->estimate.odom_from_base.covariance});
    publish(step->estimate);
  }
  followCalibration();
  if (stage_.resetCount() != reset_count_) {
    reset_count_ = stage_.resetCount();
    ROS_WARN_STREAM("The stamps on " << scan_subscriber_.getTopic()
                                     << " were set back: laser odometry starts again");
  }
  drop_log_.log(stage_.drops(),
                scan_subscriber_.getTopic() + ", " +
                    (parameters_.use_wheels ? odometry_subscriber_.getTopic() : ""));
}

void LaserOdometryNode::publish(const ram_slam::LaserOdometryEstimate& estimate) {
  if (estimate.wheels_slipped)
    ROS_WARN_THROTTLE(kLogPeriodS, "The wheels slip: scans and odometry disagree");
  if (estimate.wheels_stuck) stuck_ = ros::SteadyTime::now();
  publish(estimate.stamp_ns, estimate.odom_from_base);
}

void LaserOdometryNode::publishCalibration() {
  ram_slam_msgs::LidarCalibration message = toLidarMessage(stage_.lidarCalibration());
  message.header.stamp = toTime(stage_.lastStamp_ns());
  message.header.frame_id = parameters_.base_frame;
  calibration_publisher_.publish(message);
}

void LaserOdometryNode::followCalibration() {
  const ram_slam::LidarCalibration& calibration = stage_.lidarCalibration();
  if (calibration.addedMirrorTurn_s() == added_mirror_turn_s_) return;
  added_mirror_turn_s_ = calibration.addedMirrorTurn_s();
  publishCalibration();
  ROS_INFO_STREAM_ONCE("The scans on "
                       << scan_subscriber_.getTopic()
                       << " are corrected by what was learned: " << toText(calibration)
                       << "; later changes are on " << calibration_publisher_.getTopic());
}

void LaserOdometryNode::publish(std::int64_t stamp_ns,
                                const ram_slam::PoseWithCovariance2& odom_from_base) {
  nav_msgs::Odometry message;
  message.header.stamp = toTime(stamp_ns);
  message.header.frame_id = parameters_.odom_frame;
  message.child_frame_id = parameters_.base_frame;
  message.pose = toPoseWithCovarianceMessage(odom_from_base);
  publisher_.publish(message);
  diagnostics_.answered(stamp_ns);
}

}  // namespace ram_slam_ros
