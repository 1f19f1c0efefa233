// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam {

inline SpatialPose poseAt(double x_m, double y_m, double yaw_rad = 0.0) {
  SpatialPose pose;
  pose.position_m = {x_m, y_m, 0.25};
  pose.orientation = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
  pose.covariance = 1e-3 * Eigen::Matrix<double, 6, 6>::Identity();
  pose.covariance(0, 5) = pose.covariance(5, 0) = 2e-4;
  return pose;
}

/// Free but for an occupied cell (1, 2); cells of 0.5 m.
inline LocalOccupancy occupancyAt(const SpatialPose& map_from_frame,
                                  std::int64_t stamp_ns,
                                  const std::string& frame) {
  LocalOccupancy occupancy;
  occupancy.stamp_ns = stamp_ns;
  occupancy.frame = frame;
  occupancy.map_from_frame = map_from_frame;
  occupancy.grid.resolution_m = 0.5;
  occupancy.grid.width = 4;
  occupancy.grid.height = 3;
  occupancy.grid.cells.assign(12, kFreeCell);
  occupancy.grid.cells[occupancy.grid.index(1, 2)] = kOccupiedCell;
  return occupancy;
}

inline WorldLandmark landmarkAt(std::uint32_t id, double x_m, double y_m) {
  WorldLandmark landmark;
  landmark.id = id;
  landmark.stamp_ns = 77;
  landmark.type = "corner";
  landmark.classifier = std::string("pg1:\0:x", 7);
  landmark.pose = poseAt(x_m, y_m);
  landmark.existence_log_odds = 2.5;
  return landmark;
}

/// Landmarks 1 at (0, 0), 4 at (1, 1), 9 at (5, 5), all correlated.
inline LandmarkLayer exampleLandmarks() {
  LandmarkLayer layer;
  layer.stamp_ns = 1234;
  layer.landmarks = {landmarkAt(1, 0.0, 0.0), landmarkAt(4, 1.0, 1.0), landmarkAt(9, 5.0, 5.0)};
  const Eigen::Matrix3d block = 1e-4 * Eigen::Matrix3d::Ones();
  layer.cross_covariances = {{1, 4, block}, {1, 9, 2.0 * block}, {4, 9, 3.0 * block}};
  return layer;
}

inline ColoredCloud cloudAt(const SpatialPose& map_from_frame, const std::string& frame) {
  return {
      55, frame, map_from_frame, {{0.0F, 0.0F, 1.0F, 0xff0000U}, {2.0F, 0.0F, 1.0F, 0x00ff00U}}};
}

inline PlacedScan placedScan(std::int64_t stamp_ns, double x_m) {
  PlacedScan placed;
  placed.scan.stamp_ns = stamp_ns;
  placed.scan.angle_min_rad = -1.0;
  placed.scan.angle_increment_rad = 0.5;
  placed.scan.time_increment_s = 1e-3;
  placed.scan.range_max_m = 20.0F;
  placed.scan.ranges_m = {1.0F, std::numeric_limits<float>::infinity(), 2.5F};
  placed.base_from_laser = {0.2, 0.0, 0.1};
  placed.map_from_laser = {x_m, 0.3, -0.7};
  placed.last_beam = {0.01, 0.0, 0.001};
  return placed;
}

inline WorldMap exampleWorld() {
  WorldMap map;
  map.put(occupancyAt(poseAt(0.0, 0.0), 10, "map"));
  map.put(occupancyAt(poseAt(10.0, 0.0, M_PI_2), 20, "room"));
  map.put(exampleLandmarks());
  map.put(cloudAt(poseAt(1.0, 1.0, M_PI), "camera"));
  map.put(Trajectory{{100, {0.0, 0.0, 0.0}}, {200, {1.0, 0.5, 0.25}}});
  map.put(std::vector<PlacedScan>{placedScan(100, 1.0), placedScan(50, 2.0)});
  return map;
}

}  // namespace ram_slam
