// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/occupancy_conversions.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ram_slam/ros/conversions.hpp"

namespace ram_slam_ros {
namespace {

geometry_msgs::Pose2D toPose2D(const ram_slam::Pose2& pose) {
  geometry_msgs::Pose2D message;
  message.x = pose.x_m;
  message.y = pose.y_m;
  message.theta = pose.yaw_rad;
  return message;
}

ram_slam::Pose2 toPose2(const geometry_msgs::Pose2D& message) {
  return {message.x, message.y, message.theta};
}

}  // namespace

nav_msgs::OccupancyGrid toOccupancyGridMessage(const ram_slam::OccupancyGrid& grid,
                                               const std::string& frame_id,
                                               std::int64_t stamp_ns) {
  nav_msgs::OccupancyGrid message;
  message.header.frame_id = frame_id;
  message.header.stamp = toTime(stamp_ns);
  message.info.map_load_time = message.header.stamp;
  message.info.resolution = static_cast<float>(grid.resolution_m);
  message.info.width = static_cast<std::uint32_t>(grid.width);
  message.info.height = static_cast<std::uint32_t>(grid.height);
  message.info.origin = toPoseMessage(grid.map_from_grid);
  message.data = grid.cells;
  return message;
}

map_msgs::OccupancyGridUpdate toUpdateMessage(const ram_slam::OccupancyGrid& grid,
                                              const ram_slam::GridChange& change,
                                              const std::string& frame_id,
                                              std::int64_t stamp_ns) {
  map_msgs::OccupancyGridUpdate message;
  message.header.frame_id = frame_id;
  message.header.stamp = toTime(stamp_ns);
  message.x = change.x;
  message.y = change.y;
  message.width = static_cast<std::uint32_t>(change.width);
  message.height = static_cast<std::uint32_t>(change.height);
  for (int y = change.y; y < change.y + change.height; ++y) {
    const auto row = grid.cells.begin() + static_cast<std::ptrdiff_t>(grid.index(change.x, y));
    message.data.insert(message.data.end(), row, row + change.width);
  }
  return message;
}

ram_slam::OccupancyGrid toOccupancyGrid(const nav_msgs::OccupancyGrid& message) {
  const nav_msgs::MapMetaData& info = message.info;
  if (!(info.resolution > 0.0F) || !std::isfinite(info.resolution)) {
    throw std::invalid_argument("occupancy grid with resolution " +
                                std::to_string(info.resolution));
  }
  if (std::uint64_t{info.width} * info.height != message.data.size()) {
    throw std::invalid_argument("occupancy grid of " + std::to_string(info.width) + " x " +
                                std::to_string(info.height) + " with " +
                                std::to_string(message.data.size()) + " cells");
  }
  const auto is_cell = [](std::int8_t value) { return value >= -1 && value <= 100; };
  if (!std::all_of(message.data.begin(), message.data.end(), is_cell)) {
    throw std::invalid_argument("occupancy grid with a cell that is not in -1..100");
  }
  ram_slam::OccupancyGrid grid;
  // The message's resolution is a float: without its rounding noise, 0.05 is 0.05 again.
  grid.resolution_m = std::round(static_cast<double>(info.resolution) * 1e7) / 1e7;
  grid.map_from_grid = toPose2(info.origin);
  grid.width = static_cast<int>(info.width);
  grid.height = static_cast<int>(info.height);
  grid.cells = message.data;
  return grid;
}

ram_slam::Trajectory toTrajectory(const nav_msgs::Path& message) {
  ram_slam::Trajectory trajectory;
  trajectory.reserve(message.poses.size());
  for (const geometry_msgs::PoseStamped& pose : message.poses) {
    trajectory.push_back({toNanoseconds(pose.header.stamp), toPose2(pose.pose)});
  }
  ram_slam::validate(trajectory);
  return trajectory;
}

nav_msgs::Path toPath(const ram_slam::Trajectory& trajectory, const std::string& frame_id) {
  nav_msgs::Path path;
  path.header.frame_id = frame_id;
  if (!trajectory.empty()) path.header.stamp = toTime(trajectory.back().stamp_ns);
  path.poses.reserve(trajectory.size());
  for (const ram_slam::StampedPose2& stamped : trajectory) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = frame_id;
    pose.header.stamp = toTime(stamped.stamp_ns);
    pose.pose = toPoseMessage(stamped.pose);
    path.poses.push_back(pose);
  }
  return path;
}

ram_slam_msgs::KeyScan toKeyScanMessage(const ram_slam::PlacedScan& placed) {
  ram_slam_msgs::KeyScan message;
  message.scan = toScanMessage(placed.scan);
  message.base_from_laser = toPose2D(placed.base_from_laser);
  message.map_from_laser = toPose2D(placed.map_from_laser);
  message.last_beam = toPose2D(placed.last_beam);
  return message;
}

ram_slam::PlacedScan toPlacedScan(const ram_slam_msgs::KeyScan& message) {
  ram_slam::PlacedScan placed;
  placed.scan.stamp_ns = toNanoseconds(message.scan.header.stamp);
  placed.scan.angle_min_rad = message.scan.angle_min;
  placed.scan.angle_increment_rad = message.scan.angle_increment;
  placed.scan.time_increment_s = message.scan.time_increment;
  placed.scan.range_min_m = message.scan.range_min;
  placed.scan.range_max_m = message.scan.range_max;
  placed.scan.ranges_m = message.scan.ranges;
  placed.base_from_laser = toPose2(message.base_from_laser);
  placed.map_from_laser = toPose2(message.map_from_laser);
  placed.last_beam = toPose2(message.last_beam);
  return placed;
}

}  // namespace ram_slam_ros
