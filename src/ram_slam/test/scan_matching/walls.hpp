// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/random.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam {

/// A straight wall, for exact scans in tests.
struct Wall {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
};

using Walls = std::vector<Wall>;

/// A closed polygon.
inline Walls outline(const std::vector<Eigen::Vector2d>& corners_m) {
  Walls walls;
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    walls.push_back({corners_m[i], corners_m[(i + 1) % corners_m.size()]});
  }
  return walls;
}

inline Walls rectangle(double x_min_m, double y_min_m, double x_max_m, double y_max_m) {
  return outline({{x_min_m, y_min_m}, {x_max_m, y_min_m}, {x_max_m, y_max_m}, {x_min_m, y_max_m}});
}

inline Walls operator+(Walls a, const Walls& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Distance along a ray to the nearest wall; infinite if there is none.
inline double rangeToWalls(const Walls& walls, const Eigen::Vector2d& from_m, double bearing_rad) {
  const Eigen::Vector2d ray(std::cos(bearing_rad), std::sin(bearing_rad));
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) {
    const Eigen::Vector2d along = wall.to_m - wall.from_m;
    const Eigen::Vector2d offset = wall.from_m - from_m;
    const double denominator = ray.x() * along.y() - ray.y() * along.x();
    if (std::abs(denominator) < 1e-12) continue;
    const double range_m = (offset.x() * along.y() - offset.y() * along.x()) / denominator;
    const double fraction = (offset.x() * ray.y() - offset.y() * ray.x()) / denominator;
    if (range_m > 0.0 && fraction >= 0.0 && fraction <= 1.0)
      nearest_m = std::min(nearest_m, range_m);
  }
  return nearest_m;
}

/// A laser for tests.
struct TestLaser {
  std::size_t beam_count = 361;
  double field_of_view_rad = M_PI;
  double max_range_m = 30.0;
  double range_deviation_m = 0.0;
};

/// What the laser sees; readings beyond its range are +Inf.
/// \param last_beam  pose of a moving laser at the last beam, seen from the first
inline LaserScan scanWalls(const Walls& walls,
                           const Pose2& first_beam_in_map,
                           std::int64_t stamp_ns,
                           const TestLaser& laser = {},
                           const Pose2& last_beam = {}) {
  LaserScan scan;
  scan.stamp_ns = stamp_ns;
  scan.angle_min_rad = -0.5 * laser.field_of_view_rad;
  scan.angle_increment_rad = laser.field_of_view_rad / static_cast<double>(laser.beam_count - 1);
  scan.range_min_m = 0.01F;
  scan.range_max_m = static_cast<float>(laser.max_range_m);
  Random random(1, static_cast<std::uint64_t>(stamp_ns));
  for (std::size_t beam = 0; beam < laser.beam_count; ++beam) {
    const double fraction = static_cast<double>(beam) / static_cast<double>(laser.beam_count - 1);
    const Pose2 map_from_laser = first_beam_in_map * interpolate({}, last_beam, fraction);
    const double bearing_rad = map_from_laser.yaw_rad + scan.bearing_rad(beam);
    const double range_m = rangeToWalls(walls, map_from_laser.translation(), bearing_rad);
    const double reading_m = range_m + laser.range_deviation_m * random.gaussian();
    scan.ranges_m.push_back(range_m <= laser.max_range_m ? static_cast<float>(reading_m)
                                                         : std::numeric_limits<float>::infinity());
  }
  return scan;
}

}  // namespace ram_slam
