// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/landmark_conversions.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "ram_slam/ros/conversions.hpp"

namespace ram_slam_ros {
namespace {

using ram_slam::LandmarkCovariance;
using ram_slam::LandmarkEstimate;

constexpr int kMessageDimensions = 3;

std_msgs::Header header(std::int64_t stamp_ns, const std::string& frame_id) {
  std_msgs::Header result;
  result.stamp = toTime(stamp_ns);
  result.frame_id = frame_id;
  return result;
}

visualization_msgs::Marker ellipse(const LandmarkEstimate& landmark,
                                   const std_msgs::Header& where,
                                   const ram_slam::LandmarkMarkerParameters& parameters) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(landmark.covariance_m2);
  const Eigen::Vector2d longest = axes.eigenvectors().col(1);
  const auto diameter_m = [&axes, &parameters](int i) {
    return std::max(
        parameters.least_diameter_m,
        2.0 * parameters.ellipse_sigmas * std::sqrt(std::max(0.0, axes.eigenvalues()[i])));
  };
  visualization_msgs::Marker marker;
  marker.header = where;
  marker.ns = "landmarks";
  marker.id = static_cast<int>(landmark.id);
  marker.type = visualization_msgs::Marker::CYLINDER;
  marker.pose = toPoseMessage(
      {landmark.mean_m.x(), landmark.mean_m.y(), std::atan2(longest.y(), longest.x())});
  marker.scale.x = diameter_m(1);
  marker.scale.y = diameter_m(0);
  marker.scale.z = parameters.height_m;
  marker.color.g = 0.6F;
  marker.color.b = 1.0F;
  marker.color.a = landmark.existence_log_odds > 0.0 ? 0.9F : 0.3F;
  return marker;
}

}  // namespace

ram_slam_msgs::LandmarkMap toLandmarkMapMessage(const ram_slam::LandmarkMap& map,
                                                const std::string& frame_id) {
  ram_slam_msgs::LandmarkMap message;
  message.header = header(map.stamp_ns, frame_id);
  for (const LandmarkEstimate& landmark : map.landmarks) {
    ram_slam::Feature feature;
    feature.type = landmark.type;
    feature.classifier = landmark.classifier;
    feature.position_m = landmark.mean_m;
    feature.covariance_m2 = landmark.covariance_m2;
    feature.orientation_rad = landmark.orientation_rad;
    feature.orientation_variance_rad2 = landmark.orientation_variance_rad2;
    ram_slam_msgs::Landmark entry;
    entry.id = landmark.id;
    entry.feature = toFeatureMessage(feature, message.header);
    entry.existence_log_odds = landmark.existence_log_odds;
    message.landmarks.push_back(entry);
  }
  for (const LandmarkCovariance& block : map.covariances) {
    ram_slam_msgs::CovarianceBlock entry;
    entry.first_id = block.first_id;
    entry.second_id = block.second_id;
    entry.covariance.assign(0.0);
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 2; ++column) {
        entry.covariance[kMessageDimensions * row + column] = block.covariance_m2(row, column);
      }
    }
    message.covariances.push_back(entry);
  }
  return message;
}

std::vector<LandmarkEstimate> toLandmarkEstimates(const ram_slam_msgs::LandmarkMap& message,
                                                  const std::string& frame_id) {
  if (message.header.frame_id != frame_id) {
    throw std::invalid_argument("they are in '" + message.header.frame_id + "' instead of '" +
                                frame_id + "'");
  }
  std::vector<LandmarkEstimate> landmarks;
  for (const ram_slam_msgs::Landmark& entry : message.landmarks) {
    const ram_slam::Feature feature = toFeature(entry.feature);
    LandmarkEstimate landmark;
    landmark.id = entry.id;
    landmark.type = feature.type;
    landmark.classifier = feature.classifier;
    landmark.mean_m = feature.position_m;
    landmark.covariance_m2 = feature.covariance_m2;
    landmark.existence_log_odds = entry.existence_log_odds;
    landmark.orientation_rad = feature.orientation_rad;
    landmark.orientation_variance_rad2 = feature.orientation_variance_rad2;
    landmarks.push_back(landmark);
  }
  return landmarks;
}

visualization_msgs::MarkerArray toMarkers(const ram_slam::LandmarkMap& map,
                                          const std::string& frame_id,
                                          const ram_slam::LandmarkMarkerParameters& parameters) {
  visualization_msgs::MarkerArray markers;
  markers.markers.resize(1);
  markers.markers[0].header = header(map.stamp_ns, frame_id);
  markers.markers[0].action = visualization_msgs::Marker::DELETEALL;
  for (const LandmarkEstimate& landmark : map.landmarks) {
    markers.markers.push_back(ellipse(landmark, markers.markers[0].header, parameters));
  }
  return markers;
}

}  // namespace ram_slam_ros
