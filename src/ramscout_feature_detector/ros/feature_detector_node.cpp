// SPDX-License-Identifier: BSD-3-Clause
#include "feature_detector_node.hpp"

#include <stdexcept>

#include <sensor_msgs/Image.h>
#include <visualization_msgs/MarkerArray.h>

#include "ram_slam/ros/conversions.hpp"
#include "ramscout_feature_detector/processing_picture.hpp"

#include "markers.hpp"

namespace ramscout_feature_detector_ros {
namespace {

constexpr std::size_t kMostLasers = 32;

/// A frame without the leading slash that tf2 refuses.
std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

}  // namespace

FeatureDetectorNode::FeatureDetectorNode(ram_parameters::ParameterReader& reader)
    : detector_(ramscout_feature_detector::readFeatureDetectorParameters(reader)),
      tf_listener_(tf_buffer_) {
  for (const std::string& warning : detector_.parameters().warnings()) ROS_WARN_STREAM(warning);
  ros::NodeHandle node;
  features_publisher_ = node.advertise<ram_slam_msgs::FeatureList>("features", 10);
  markers_publisher_ = node.advertise<visualization_msgs::MarkerArray>("feature_markers", 1);
  image_publisher_ = node.advertise<sensor_msgs::Image>("feature_image", 1);
  scan_subscriber_ = node.subscribe("scan", 10, &FeatureDetectorNode::onScan, this,
                                    ros::TransportHints().tcpNoDelay());
  ROS_INFO_STREAM("Looking for corners in " << scan_subscriber_.getTopic() << ", features in frame "
                                            << detector_.parameters().base_frame);
}

void FeatureDetectorNode::onScan(const sensor_msgs::LaserScan& message) {
  try {
    process(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(5.0, "Skipped a scan: " << error.what());
  }
}

void FeatureDetectorNode::process(const sensor_msgs::LaserScan& message) {
  const std::string laser_frame = withoutSlash(message.header.frame_id);
  if (laser_frame.empty()) throw std::invalid_argument("its frame_id is empty");
  ram_slam::LaserScan scan = ram_slam_ros::toLaserScan(message);
  const ram_slam_ros::Mounting mounting = mountingOf(laser_frame);
  ros::Time& last_stamp = last_stamps_[laser_frame];
  if (message.header.stamp == last_stamp) return;  // the same message again
  last_stamp = message.header.stamp;

  if (mounting.upside_down) scan = ram_slam::mirrored(std::move(scan));
  const auto list = detector_.detect(scan, mounting.base_from_sensor);
  const auto features = ram_slam_ros::toFeatureListMessage(list, detector_.parameters().base_frame);
  features_publisher_.publish(features);
  show(scan, list, mounting.base_from_sensor, features.header);
}

void FeatureDetectorNode::show(const ram_slam::LaserScan& scan,
                               const ram_slam::FeatureList& list,
                               const ram_slam::Pose2& base_from_laser,
                               const std_msgs::Header& header) {
  if (markers_publisher_.getNumSubscribers() > 0) {
    markers_publisher_.publish(toMarkers(list, detector_.analyse(scan), base_from_laser,
                                         detector_.parameters().occlude_limit, header));
  }
  if (image_publisher_.getNumSubscribers() > 0) {
    auto picture = ramscout_feature_detector::pictureOfProcessing(detector_, scan);
    sensor_msgs::Image image;
    image.header = header;
    image.width = static_cast<std::uint32_t>(picture.columns);
    image.height = static_cast<std::uint32_t>(picture.rows);
    image.encoding = "rgb8";
    image.step = 3 * image.width;
    image.data = std::move(picture.rgb);
    image_publisher_.publish(image);
  }
}

ram_slam_ros::Mounting FeatureDetectorNode::mountingOf(const std::string& laser_frame) {
  const auto known = mountings_.find(laser_frame);
  if (known != mountings_.end()) return known->second;
  if (mountings_.size() >= kMostLasers) {
    throw std::invalid_argument("more than " + std::to_string(kMostLasers) + " laser frames");
  }
  const auto transform =
      tf_buffer_.lookupTransform(detector_.parameters().base_frame, laser_frame, ros::Time(0));
  const ram_slam_ros::Mounting mounting = ram_slam_ros::toMounting(transform.transform);
  mountings_[laser_frame] = mounting;
  ROS_INFO_STREAM("Laser " << laser_frame << (mounting.upside_down ? " (upside down)" : "")
                           << " at " << mounting.base_from_sensor.x_m << ", "
                           << mounting.base_from_sensor.y_m << " m, "
                           << mounting.base_from_sensor.yaw_rad << " rad");
  return mounting;
}

}  // namespace ramscout_feature_detector_ros
