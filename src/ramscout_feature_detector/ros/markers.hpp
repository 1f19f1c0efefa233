// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

namespace ramscout_feature_detector_ros {

/// Features as one-sigma ellipses with their bisectors, if they have a direction. Replaces the
/// markers of the scan before.
visualization_msgs::MarkerArray featureMarkers(
    const ram_slam::FeatureList& list,
    const std_msgs::Header& header,
    const ramscout_feature_detector::MarkerParameters& parameters);

/// The regions around surfaces' ends, where no feature is accepted, as circles.
visualization_msgs::Marker exclusionMarker(
    const ramscout_feature_detector::FeatureDetector::Analysis& analysis,
    const ram_slam::Pose2& base_from_laser,
    const ramscout_feature_detector::FeatureDetectorParameters& parameters,
    const std_msgs::Header& header);

}  // namespace ramscout_feature_detector_ros
