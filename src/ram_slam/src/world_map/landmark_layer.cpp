// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/landmark_layer.hpp"

#include <utility>

namespace ram_slam {
namespace {

SpatialPose placeOf(const LandmarkEstimate& landmark) {
  SpatialPose pose;
  pose.position_m.head<2>() = landmark.mean_m;
  pose.orientation = Eigen::AngleAxisd(landmark.orientation_rad, Eigen::Vector3d::UnitZ());
  pose.covariance.diagonal().setConstant(SpatialPose::kUnknownVariance);
  pose.covariance.topLeftCorner<2, 2>() = landmark.covariance_m2;
  pose.covariance(5, 5) = landmark.orientation_variance_rad2;
  return pose;
}

}  // namespace

LandmarkLayer toLandmarkLayer(const LandmarkMap& map) {
  LandmarkLayer layer;
  layer.stamp_ns = map.stamp_ns;
  for (const LandmarkEstimate& from : map.landmarks) {
    WorldLandmark landmark;
    landmark.id = from.id;
    landmark.stamp_ns = from.placed_ns;
    landmark.type = from.type;
    landmark.classifier = from.classifier;
    landmark.pose = placeOf(from);
    landmark.existence_log_odds = from.existence_log_odds;
    layer.landmarks.push_back(std::move(landmark));
  }
  return layer;
}

LandmarkMap toLandmarkMap(const LandmarkLayer& layer) {
  LandmarkMap map;
  map.stamp_ns = layer.stamp_ns;
  for (const WorldLandmark& from : layer.landmarks) {
    LandmarkEstimate landmark;
    landmark.id = from.id;
    landmark.type = from.type;
    landmark.classifier = from.classifier;
    const Pose2 pose = from.pose.planar();
    landmark.mean_m = pose.translation();
    landmark.covariance_m2 = from.pose.covariance.topLeftCorner<2, 2>();
    landmark.existence_log_odds = from.existence_log_odds;
    landmark.orientation_rad = pose.yaw_rad;
    landmark.orientation_variance_rad2 = from.pose.covariance(5, 5);
    map.landmarks.push_back(std::move(landmark));
  }
  return map;
}

}  // namespace ram_slam
