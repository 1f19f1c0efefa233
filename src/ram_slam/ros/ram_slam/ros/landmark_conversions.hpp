// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <ram_slam_msgs/LandmarkMap.h>
#include <visualization_msgs/MarkerArray.h>

#include "ram_slam/fast_slam/landmark_map.hpp"
#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam_ros {

ram_slam_msgs::LandmarkMap toLandmarkMapMessage(const ram_slam::LandmarkMap& map,
                                                const std::string& frame_id);

/// The planar landmarks of a stored map, without their cross-covariances.
ram_slam::LandmarkMap toLandmarkMap(const ram_slam::LandmarkLayer& layer);

/// For rviz: the 2-sigma ellipse of every landmark, faint while its existence is in doubt. Replaces
/// all earlier ones.
visualization_msgs::MarkerArray toMarkers(const ram_slam::LandmarkMap& map,
                                          const std::string& frame_id);

}  // namespace ram_slam_ros
