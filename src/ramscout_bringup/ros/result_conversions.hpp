// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/LandmarkMap.h>

#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup_ros {

/// \throws std::invalid_argument if a pose is not finite
ramscout_bringup::Trajectory toTrajectory(const nav_msgs::Path& message);

/// \throws std::invalid_argument if the number of cells is not width x height
ram_slam::OccupancyGrid toOccupancyGrid(const nav_msgs::OccupancyGrid& message);

/// \throws std::invalid_argument as ram_slam_ros::toFeature
std::vector<ramscout_bringup::MapLandmark> toMapLandmarks(
    const ram_slam_msgs::LandmarkMap& message);

}  // namespace ramscout_bringup_ros
