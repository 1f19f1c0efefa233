// SPDX-License-Identifier: BSD-3-Clause
#include "feature_detector_node.hpp"

#include <sensor_msgs/Image.h>
#include <visualization_msgs/MarkerArray.h>

#include "ram_slam/ros/conversions.hpp"
#include "ramscout_feature_detector/processing_picture.hpp"

#include "markers.hpp"

namespace ramscout_feature_detector_ros {

FeatureDetectorNode::FeatureDetectorNode(ram_parameters::ParameterReader& reader)
    : detector_(ramscout_feature_detector::readFeatureDetectorParameters(reader)),
      features_publisher_(ros::NodeHandle().advertise<ram_slam_msgs::FeatureList>("features", 10)),
      markers_publisher_(
          ros::NodeHandle().advertise<visualization_msgs::MarkerArray>("feature_markers", 1)),
      image_publisher_(ros::NodeHandle().advertise<sensor_msgs::Image>("feature_image", 1)),
      input_(detector_.parameters().node,
             features_publisher_.getTopic(),
             [this](const auto& scan, const auto& pose) { detect(scan, pose); }) {
  for (const std::string& warning : detector_.parameters().warnings()) ROS_WARN_STREAM(warning);
  ROS_INFO_STREAM("Searching for corners, publishing features in frame "
                  << detector_.parameters().node.base_frame);
}

void FeatureDetectorNode::detect(const ram_slam::LaserScan& scan,
                                 const ram_slam::Pose2& base_from_laser) {
  const ram_slam::FeatureList list = detector_.detect(scan, base_from_laser);
  const auto features =
      ram_slam_ros::toFeatureListMessage(list, detector_.parameters().node.base_frame);
  features_publisher_.publish(features);
  show(scan, list, base_from_laser, features.header);
}

void FeatureDetectorNode::show(const ram_slam::LaserScan& scan,
                               const ram_slam::FeatureList& list,
                               const ram_slam::Pose2& base_from_laser,
                               const std_msgs::Header& header) {
  if (markers_publisher_.getNumSubscribers() > 0) {
    auto markers = featureMarkers(list, header, detector_.parameters().node.markers);
    markers.markers.push_back(
        exclusionMarker(detector_.analyse(scan), base_from_laser, detector_.parameters(), header));
    markers_publisher_.publish(markers);
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

}  // namespace ramscout_feature_detector_ros
