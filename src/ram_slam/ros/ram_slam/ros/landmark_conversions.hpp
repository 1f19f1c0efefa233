// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <ram_slam_msgs/LandmarkMap.h>
#include <visualization_msgs/MarkerArray.h>

#include "ram_slam/landmarks/landmark_map.hpp"
#include "ram_slam/stages/fast_slam_node_parameters.hpp"

namespace ram_slam_ros {

ram_slam_msgs::LandmarkMap toLandmarkMapMessage(const ram_slam::LandmarkMap& map,
                                                const std::string& frame_id);

/// The planar part of the landmarks. \throws std::invalid_argument if they are in another frame, or
/// as toFeature()
std::vector<ram_slam::LandmarkEstimate> toLandmarkEstimates(
    const ram_slam_msgs::LandmarkMap& message, const std::string& frame_id);

/// For rviz: the ellipse of every landmark, faint while its existence is in doubt. Replaces
/// all earlier ones.
visualization_msgs::MarkerArray toMarkers(const ram_slam::LandmarkMap& map,
                                          const std::string& frame_id,
                                          const ram_slam::LandmarkMarkerParameters& parameters);

}  // namespace ram_slam_ros
