// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/random.hpp"
#include "ramscout_feature_detector/contour.hpp"

namespace ramscout_feature_detector {

/// Points at equal distances of about `spacing_m` along a polyline, its corners among them.
inline std::vector<Eigen::Vector2d> pointsAlong(const std::vector<Eigen::Vector2d>& corners_m,
                                                double spacing_m) {
  std::vector<Eigen::Vector2d> points_m{corners_m.front()};
  for (std::size_t i = 1; i < corners_m.size(); ++i) {
    const Eigen::Vector2d step_m = corners_m[i] - corners_m[i - 1];
    const int count = static_cast<int>(std::lround(step_m.norm() / spacing_m));
    for (int j = 1; j <= count; ++j)
      points_m.emplace_back(corners_m[i - 1] + step_m * (static_cast<double>(j) / count));
  }
  return points_m;
}

/// The same points moved along their beams by range noise.
inline std::vector<Eigen::Vector2d> noisy(std::vector<Eigen::Vector2d> points_m,
                                          double sigma_m,
                                          ram_slam::Random& random) {
  for (Eigen::Vector2d& point_m : points_m)
    point_m += sigma_m * random.gaussian() * point_m.normalized();
  return points_m;
}

/// Two walls of 1.5 m that meet at (3, 0) with an opening angle towards the laser, as 151 points
/// each.
inline std::vector<Eigen::Vector2d> wallsMeeting(double opening_rad) {
  const Eigen::Vector2d corner_m(3.0, 0.0);
  const Eigen::Vector2d below(-std::cos(0.5 * opening_rad), -std::sin(0.5 * opening_rad));
  const Eigen::Vector2d above(-std::cos(0.5 * opening_rad), std::sin(0.5 * opening_rad));
  return pointsAlong({corner_m + 1.5 * below, corner_m, corner_m + 1.5 * above}, 0.01);
}

}  // namespace ramscout_feature_detector
