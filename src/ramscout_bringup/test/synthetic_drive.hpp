// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/stages/scan_synchroniser.hpp"

namespace ramscout_bringup {

/// A drive once around the pillar of a room of 8 x 6 m with an alcove, with exact scans and with
/// wheels that are wrong by constant factors.
struct SyntheticDrive {
  ram_slam::Trajectory truth;   ///< room_from_base at each scan
  ram_slam::Trajectory wheels;  ///< odom_from_base at each scan; starts at the origin
  std::vector<ram_slam::MountedScan> scans;
};

struct Segment {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
};

inline std::vector<Segment> polygon(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<Segment> sides;
  for (std::size_t i = 0; i < corners.size(); ++i)
    sides.push_back({corners[i], corners[(i + 1) % corners.size()]});
  return sides;
}

inline std::vector<Segment> roomWithPillar() {
  std::vector<Segment> walls =
      polygon({{-4, -3}, {4, -3}, {4, 1}, {5, 1}, {5, 2}, {4, 2}, {4, 3}, {-4, 3}});
  const std::vector<Segment> pillar = polygon({{-0.5, -0.4}, {0.6, -0.4}, {0.6, 0.4}, {-0.5, 0.4}});
  walls.insert(walls.end(), pillar.begin(), pillar.end());
  return walls;
}

/// Distance along a ray to the nearest wall [m]: p + t d = a + s (b - a), by Cramer's rule.
inline double castRay(const std::vector<Segment>& walls,
                      const Eigen::Vector2d& from_m,
                      double bearing_rad) {
  const Eigen::Vector2d d(std::cos(bearing_rad), std::sin(bearing_rad));
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Segment& wall : walls) {
    const Eigen::Vector2d e = wall.to_m - wall.from_m;
    const Eigen::Vector2d r = wall.from_m - from_m;
    const double determinant = d.y() * e.x() - d.x() * e.y();
    if (std::abs(determinant) < 1e-12) continue;
    const double t = (r.y() * e.x() - r.x() * e.y()) / determinant;
    const double s = (d.x() * r.y() - d.y() * r.x()) / determinant;
    if (t > 0.0 && s >= 0.0 && s <= 1.0) nearest_m = std::min(nearest_m, t);
  }
  return nearest_m;
}

/// 180 beams over the full turn.
inline ram_slam::LaserScan scanAt(const std::vector<Segment>& walls,
                                  const ram_slam::StampedPose2& room_from_laser) {
  constexpr int kBeams = 180;
  ram_slam::LaserScan scan;
  scan.stamp_ns = room_from_laser.stamp_ns;
  scan.angle_min_rad = -M_PI;
  scan.angle_increment_rad = 2.0 * M_PI / kBeams;
  scan.range_min_m = 0.05F;
  scan.range_max_m = 20.0F;
  for (int i = 0; i < kBeams; ++i) {
    scan.ranges_m.push_back(static_cast<float>(
        castRay(walls, room_from_laser.pose.translation(),
                room_from_laser.pose.yaw_rad + scan.bearing_rad(static_cast<std::size_t>(i)))));
  }
  return scan;
}

/// \param distance_ratio, turn_ratio  wheels by truth
inline SyntheticDrive driveAroundThePillar(double distance_ratio = 1.05, double turn_ratio = 0.96) {
  constexpr int kSteps = 120;
  constexpr std::int64_t kPeriodNs = 200'000'000;
  const ram_slam::Pose2 base_from_laser{0.15, 0.0, 0.0};
  const std::vector<Segment> walls = roomWithPillar();
  SyntheticDrive drive;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle_rad = 2.0 * M_PI * i / kSteps;
    const ram_slam::Pose2 pose{2.0 * std::cos(angle_rad), 1.6 * std::sin(angle_rad),
                               std::atan2(1.6 * std::cos(angle_rad), -2.0 * std::sin(angle_rad))};
    const std::int64_t stamp_ns = 1'000'000'000 + i * kPeriodNs;
    ram_slam::Pose2 odom_from_base;
    if (i > 0) {
      const ram_slam::Pose2 step = drive.truth.back().pose.inverse() * pose;
      odom_from_base = drive.wheels.back().pose * ram_slam::Pose2{distance_ratio * step.x_m,
                                                                  distance_ratio * step.y_m,
                                                                  turn_ratio * step.yaw_rad};
    }
    drive.truth.push_back({stamp_ns, pose});
    drive.wheels.push_back({stamp_ns, odom_from_base});
    drive.scans.push_back({scanAt(walls, {stamp_ns, pose * base_from_laser}), base_from_laser});
  }
  return drive;
}

}  // namespace ramscout_bringup
