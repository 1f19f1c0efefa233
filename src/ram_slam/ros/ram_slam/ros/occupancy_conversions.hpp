// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include <map_msgs/OccupancyGridUpdate.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/KeyScan.h>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/occupancy/occupancy_grid.hpp"
#include "ram_slam/occupancy/occupancy_mapper.hpp"
#include "ram_slam/sensing/placed_scan.hpp"

namespace ram_slam_ros {

/// \param stamp_ns  of the newest data in the map
nav_msgs::OccupancyGrid toOccupancyGridMessage(const ram_slam::OccupancyGrid& grid,
                                               const std::string& frame_id,
                                               std::int64_t stamp_ns);

/// The cells of `change`, for consumers that have the rest of the grid.
map_msgs::OccupancyGridUpdate toUpdateMessage(const ram_slam::OccupancyGrid& grid,
                                              const ram_slam::GridChange& change,
                                              const std::string& frame_id,
                                              std::int64_t stamp_ns);

/// The grid of a message; its rotation is kept.
/// \throws std::invalid_argument if the resolution is not positive and finite, the origin not a
/// pose, the number of cells
///         not width times height, or a cell not in -1..100
ram_slam::OccupancyGrid toOccupancyGrid(const nav_msgs::OccupancyGrid& message);

/// Poses at their own headers' stamps. \throws std::invalid_argument as toPose2() and
/// validate(Trajectory)
ram_slam::Trajectory toTrajectory(const nav_msgs::Path& message);

/// The other way; the path's stamp is that of its last pose.
nav_msgs::Path toPath(const ram_slam::Trajectory& trajectory, const std::string& frame_id);

/// toPlacedScan() gives back the same numbers if those of the scan were read from a message.
ram_slam_msgs::KeyScan toKeyScanMessage(const ram_slam::PlacedScan& placed);
/// As it is, without what toLaserScan() makes of the readings of drivers.
ram_slam::PlacedScan toPlacedScan(const ram_slam_msgs::KeyScan& message);

}  // namespace ram_slam_ros
