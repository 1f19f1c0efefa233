// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/mounting.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

namespace ramscout_feature_detector_ros {

/// Turns `scan` into `features`, in the base frame; `feature_markers` and `feature_image` (the
/// processing, see pictureOfProcessing()) if somebody wants to see them.
///
/// The mounting of each laser (frame of the scan) is read from tf once: lasers are bolted on.
class FeatureDetectorNode {
public:
  /// \throws std::invalid_argument for parameters that are unknown or out of range
  explicit FeatureDetectorNode(ram_parameters::ParameterReader& reader);

private:
  void onScan(const sensor_msgs::LaserScan& message);
  /// Markers and picture, if somebody wants to see them.
  void show(const ram_slam::LaserScan& scan,
            const ram_slam::FeatureList& list,
            const ram_slam::Pose2& base_from_laser,
            const std_msgs::Header& header);
  void process(const sensor_msgs::LaserScan& message);
  /// \throws tf2::TransformException if it is not known, std::invalid_argument if the laser is not
  /// level
  ram_slam_ros::Mounting mountingOf(const std::string& laser_frame);

  ramscout_feature_detector::FeatureDetector detector_;
  tf2_ros::Buffer tf_buffer_;
  tf2_ros::TransformListener tf_listener_;
  std::map<std::string, ram_slam_ros::Mounting> mountings_;
  std::map<std::string, ros::Time> last_stamps_;
  ros::Publisher features_publisher_;
  ros::Publisher markers_publisher_;
  ros::Publisher image_publisher_;
  ros::Subscriber scan_subscriber_;
};

}  // namespace ramscout_feature_detector_ros
