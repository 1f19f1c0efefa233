// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/random.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ramscout_feature_detector {

/// Walls for tests, and an exact lidar in them.
struct PolygonWorld {
  struct Wall {
    Eigen::Vector2d from_m;
    Eigen::Vector2d to_m;
  };
  std::vector<Wall> walls;

  /// A chain of walls through the corners; closed: the last one joins the first.
  void add(const std::vector<Eigen::Vector2d>& corners_m, bool closed) {
    for (std::size_t i = 0; i + (closed ? 0 : 1) < corners_m.size(); ++i) {
      walls.push_back({corners_m[i], corners_m[(i + 1) % corners_m.size()]});
    }
  }

  /// What a beam meets first; wall -1 and an infinite range if nothing.
  struct Hit {
    int wall = -1;
    double range_m = std::numeric_limits<double>::infinity();
  };
  Hit hit(const Eigen::Vector2d& from_m, double bearing_rad) const {
    const Eigen::Vector2d beam(std::cos(bearing_rad), std::sin(bearing_rad));
    Hit first;
    for (std::size_t i = 0; i < walls.size(); ++i) {
      const Eigen::Vector2d along = walls[i].to_m - walls[i].from_m;
      const Eigen::Vector2d offset = walls[i].from_m - from_m;
      const double determinant = beam.x() * along.y() - beam.y() * along.x();
      if (std::abs(determinant) < 1e-12) continue;
      const double t = (offset.x() * along.y() - offset.y() * along.x()) / determinant;
      const double s = (offset.x() * beam.y() - offset.y() * beam.x()) / determinant;
      if (t > 0.0 && s >= 0.0 && s <= 1.0 && t < first.range_m) first = {static_cast<int>(i), t};
    }
    return first;
  }

  /// A Hokuyo UTM-30LX's view: 1081 beams over 270 degrees, +Inf beyond 30 m.
  ram_slam::LaserScan scan(const ram_slam::Pose2& world_from_laser,
                           double noise_m,
                           ram_slam::Random& random) const {
    return scan(world_from_laser, noise_m, random, 1081, -0.75 * M_PI, M_PI / 720.0);
  }

  ram_slam::LaserScan scan(const ram_slam::Pose2& world_from_laser,
                           double noise_m,
                           ram_slam::Random& random,
                           int beams,
                           double angle_min_rad,
                           double increment_rad) const {
    ram_slam::LaserScan scan;
    scan.stamp_ns = 1;
    scan.angle_min_rad = angle_min_rad;
    scan.angle_increment_rad = increment_rad;
    scan.range_min_m = 0.05F;
    scan.range_max_m = 30.0F;
    for (int beam = 0; beam < beams; ++beam) {
      const double exact_m =
          hit(world_from_laser.translation(), world_from_laser.yaw_rad + scan.bearing_rad(beam))
              .range_m;
      const double measured_m = exact_m + noise_m * random.gaussian();
      scan.ranges_m.push_back(exact_m < 30.0 ? static_cast<float>(measured_m)
                                             : std::numeric_limits<float>::infinity());
    }
    return scan;
  }
};

/// A wall 3 m ahead with a door of 1 m, and another wall 3 m behind it.
inline PolygonWorld door() {
  PolygonWorld world;
  world.add({{3.0, -6.0}, {3.0, -0.5}}, false);
  world.add({{3.0, 0.5}, {3.0, 6.0}}, false);
  world.add({{6.0, -20.0}, {6.0, 20.0}}, false);
  return world;
}

}  // namespace ramscout_feature_detector
