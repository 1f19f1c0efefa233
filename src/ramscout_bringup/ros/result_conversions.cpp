// SPDX-License-Identifier: BSD-3-Clause
#include "result_conversions.hpp"

#include <stdexcept>

#include <ram_slam/ros/conversions.hpp>

namespace ramscout_bringup_ros {

ramscout_bringup::Trajectory toTrajectory(const nav_msgs::Path& message) {
  ramscout_bringup::Trajectory trajectory;
  trajectory.reserve(message.poses.size());
  for (const geometry_msgs::PoseStamped& pose : message.poses) {
    trajectory.push_back(
        {ram_slam_ros::toNanoseconds(pose.header.stamp), ram_slam_ros::toPose2(pose.pose)});
  }
  return trajectory;
}

ram_slam::OccupancyGrid toOccupancyGrid(const nav_msgs::OccupancyGrid& message) {
  if (message.data.size() != static_cast<std::size_t>(message.info.width) * message.info.height) {
    throw std::invalid_argument("occupancy grid with " + std::to_string(message.data.size()) +
                                " cells instead of " + std::to_string(message.info.width) + " x " +
                                std::to_string(message.info.height));
  }
  ram_slam::OccupancyGrid grid;
  grid.resolution_m = message.info.resolution;
  grid.map_from_grid = ram_slam_ros::toPose2(message.info.origin);
  grid.width = static_cast<int>(message.info.width);
  grid.height = static_cast<int>(message.info.height);
  grid.cells = message.data;
  return grid;
}

std::vector<ramscout_bringup::MapLandmark> toMapLandmarks(
    const ram_slam_msgs::LandmarkMap& message) {
  std::vector<ramscout_bringup::MapLandmark> landmarks;
  for (const ram_slam_msgs::Landmark& landmark : message.landmarks) {
    const ram_slam::Feature feature = ram_slam_ros::toFeature(landmark.feature);
    landmarks.push_back({landmark.id, feature.type, feature.classifier, feature.position_m,
                         feature.covariance_m2, landmark.existence_log_odds});
  }
  return landmarks;
}

}  // namespace ramscout_bringup_ros
