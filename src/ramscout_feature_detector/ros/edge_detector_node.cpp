// SPDX-License-Identifier: BSD-3-Clause
#include "edge_detector_node.hpp"

#include <visualization_msgs/MarkerArray.h>

#include "ram_slam/ros/conversions.hpp"

#include "markers.hpp"

namespace ramscout_feature_detector_ros {

EdgeDetectorNode::EdgeDetectorNode(ram_parameters::ParameterReader& reader)
    : detector_(ramscout_feature_detector::readEdgeDetectorParameters(reader)),
      features_publisher_(ros::NodeHandle().advertise<ram_slam_msgs::FeatureList>("features", 10)),
      markers_publisher_(
          ros::NodeHandle().advertise<visualization_msgs::MarkerArray>("feature_markers", 1)),
      input_(detector_.parameters().node,
             features_publisher_.getTopic(),
             [this](const auto& scan, const auto& pose) { detect(scan, pose); }) {
  ROS_INFO_STREAM("Searching for edges, publishing features in frame "
                  << detector_.parameters().node.base_frame);
}

void EdgeDetectorNode::detect(const ram_slam::LaserScan& scan,
                              const ram_slam::Pose2& base_from_laser) {
  const ram_slam::FeatureList list = detector_.detect(scan, base_from_laser);
  const auto features =
      ram_slam_ros::toFeatureListMessage(list, detector_.parameters().node.base_frame);
  features_publisher_.publish(features);
  if (markers_publisher_.getNumSubscribers() > 0) {
    markers_publisher_.publish(
        featureMarkers(list, features.header, detector_.parameters().node.markers));
  }
}

}  // namespace ramscout_feature_detector_ros
