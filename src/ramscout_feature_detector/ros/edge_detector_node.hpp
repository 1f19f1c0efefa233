// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_feature_detector/edge_detector.hpp"

#include "scan_input.hpp"

namespace ramscout_feature_detector_ros {

/// Turns `scan` into `features` of type "edge", in the base frame; `feature_markers` if a node
/// wants to see them.
class EdgeDetectorNode {
public:
  /// \throws std::invalid_argument for parameters that are unknown or out of range
  explicit EdgeDetectorNode(ram_parameters::ParameterReader& reader);

private:
  void detect(const ram_slam::LaserScan& scan, const ram_slam::Pose2& base_from_laser);

  ramscout_feature_detector::EdgeDetector detector_;
  ros::Publisher features_publisher_;
  ros::Publisher markers_publisher_;
  ScanInput input_;
};

}  // namespace ramscout_feature_detector_ros
