// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/ros/mounting.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ramscout_feature_detector/shared_parameters.hpp"

namespace ramscout_feature_detector_ros {

/// Subscribes `scan` and passes on each scan once, as an upright laser would have given it, with
/// the pose of the laser. What cannot be used is skipped with a warning; of what is odd but can be
/// used it warns once. States on /diagnostics how the detector does.
///
/// The mounting of each laser (frame of the scan) is read from tf once: lasers are bolted on.
class ScanInput {
public:
  using Callback =
      std::function<void(const ram_slam::LaserScan&, const ram_slam::Pose2& base_from_laser)>;

  /// \param output  topic of the features
  /// \param use  publishes them; may throw: the scan is then skipped with a warning
  ScanInput(const ramscout_feature_detector::DetectorNodeParameters& parameters,
            const std::string& output,
            Callback use);

private:
  void onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event);
  ram_slam_ros::NodeDiagnostics::Report report() const;
  void process(const sensor_msgs::LaserScan& message);
  /// \throws tf2::TransformException if it is not known, std::invalid_argument if the laser is not
  /// level
  ram_slam_ros::Mounting mountingOf(const std::string& laser_frame);

  ramscout_feature_detector::DetectorNodeParameters parameters_;
  Callback use_;
  tf2_ros::Buffer tf_buffer_;
  tf2_ros::TransformListener tf_listener_;
  std::map<std::string, ram_slam_ros::Mounting> mountings_;
  std::map<std::string, ros::Time> last_stamps_;
  std::set<std::string> warned_;
  ram_slam::DropCounter drops_;
  ram_slam::LossCounter messages_;
  ros::Subscriber scan_subscriber_;
  ram_slam_ros::NodeDiagnostics diagnostics_;
  ram_slam_ros::NodeDiagnostics::Input& scan_input_;
};

}  // namespace ramscout_feature_detector_ros
