// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/surface_scan.hpp"

namespace ram_slam {

/// A scan that stands for those about it.
struct KeyScan {
  std::int64_t stamp_ns = 0;
  SurfaceScan surfaces;
  Pose2 base_from_laser;
  Pose2 odom_from_laser;      ///< as it was given
  Pose2 map_from_laser;       ///< as it is corrected
  double inlier_ratio = 1.0;  ///< share of its points that meet the key scans before
  /// Before it scans are missing for long, it does not meet those before, or the estimator came to
  /// be lost: the robot may have been carried here.
  bool may_be_jump = false;
  bool is_jump = false;  ///< it was: nothing measures the motion from the key scan before
  /// The robot was found here after it had been lost: its place is measured, the motion is not.
  bool is_start = false;
  bool is_loaded = false;  ///< of a map made before, in which it stays where it is
  double path_m = 0.0;     ///< driven up to here, turning counted in
  /// Mean of the points that it sees near by.
  Eigen::Vector2d view_centre_in_laser_m = Eigen::Vector2d::Zero();

  Pose2 map_from_base() const { return map_from_laser * base_from_laser.inverse(); }
  Pose2 odom_from_base() const { return odom_from_laser * base_from_laser.inverse(); }
  Eigen::Vector2d viewCentreInMap() const { return map_from_laser * view_centre_in_laser_m; }
};

/// The pose of a key scan's laser, seen from that of another one.
inline Pose2 relativePose(const KeyScan& from, const KeyScan& to) {
  return from.map_from_laser.inverse() * to.map_from_laser;
}

/// The same for two key scans beside those of an edge, if the edge is right.
inline Pose2 relativePoseBy(const PoseEdge& edge,
                            const std::vector<KeyScan>& key_scans,
                            std::size_t from,
                            std::size_t to) {
  return relativePose(key_scans[from], key_scans[edge.from]) * edge.from_from_to *
         relativePose(key_scans[edge.to], key_scans[to]);
}

}  // namespace ram_slam
