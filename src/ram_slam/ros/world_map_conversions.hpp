// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <geometry_msgs/PoseWithCovariance.h>
#include <ram_slam_msgs/ColoredCloud.h>
#include <ram_slam_msgs/GetRegion.h>
#include <ram_slam_msgs/LandmarkMap.h>
#include <ram_slam_msgs/LocalOccupancy.h>

#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam_ros {

// What WorldMap::put() checks is not checked here.

ram_slam::LocalOccupancy toLocalOccupancy(const ram_slam_msgs::LocalOccupancy& message);

ram_slam::LandmarkLayer toLandmarkLayer(const ram_slam_msgs::LandmarkMap& message);
ram_slam_msgs::LandmarkMap toLandmarkMapMessage(const ram_slam::LandmarkLayer& landmarks,
                                                const std::string& frame_id);

/// Points that are not finite are left out: that is how PCL marks invalid ones.
/// \throws std::invalid_argument unless x, y, z are float32, rgb is a float32 or uint32 and the
/// data has the size that
///         its fields state
ram_slam::ColoredCloud toColoredCloud(const ram_slam_msgs::ColoredCloud& message);
ram_slam_msgs::ColoredCloud toColoredCloudMessage(const ram_slam::ColoredCloud& cloud,
                                                  const std::string& frame_id);

/// The answer with success set.
ram_slam_msgs::GetRegion::Response toRegionResponse(const ram_slam::MapRegion& region,
                                                    const std::string& frame_id);

}  // namespace ram_slam_ros
