// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

#include "scan_input.hpp"

namespace ramscout_feature_detector_ros {

/// Turns `scan` into `features`, in the base frame; `feature_markers` and `feature_image` (the
/// processing, see pictureOfProcessing()) while they are subscribed to.
class FeatureDetectorNode {
public:
  /// \throws std::invalid_argument for parameters that are unknown or out of range
  explicit FeatureDetectorNode(ram_parameters::ParameterReader& reader);

private:
  void detect(const ram_slam::LaserScan& scan, const ram_slam::Pose2& base_from_laser);
  /// Markers and picture, while they are subscribed to.
  void show(const ram_slam::LaserScan& scan,
            const ram_slam::FeatureList& list,
            const ram_slam::Pose2& base_from_laser,
            const std_msgs::Header& header);

  ramscout_feature_detector::FeatureDetector detector_;
  ros::Publisher features_publisher_;
  ros::Publisher markers_publisher_;
  ros::Publisher image_publisher_;
  ScanInput input_;
};

}  // namespace ramscout_feature_detector_ros
