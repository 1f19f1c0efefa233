// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "ram_slam/smoothing/key_scans.hpp"

#include "../scan_matching/walls.hpp"

namespace ram_slam {

/// A room of 8 m by 6 m with two pillars: no two places see the same.
inline Walls pillarRoom() {
  return rectangle(-2.0, -2.5, 6.0, 3.5) + rectangle(1.0, 1.5, 1.4, 2.1) +
         rectangle(3.6, -1.9, 4.4, -1.5);
}

/// Key scans of a laser in the base's origin that sees all round.
inline KeyScans scansAt(const Walls& walls,
                        const std::vector<Pose2>& truth,
                        const std::vector<Pose2>& odometry,
                        const KeyScanParameters& parameters = {}) {
  TestLaser laser;
  laser.field_of_view_rad = 2.0 * M_PI * 359.0 / 360.0;
  laser.beam_count = 360;
  KeyScans scans(parameters, {}, {}, 0.4);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto stamp_ns = static_cast<std::int64_t>(i + 1) * 100'000'000;
    scans.add(scanWalls(walls, truth[i], stamp_ns, laser), {}, odometry[i]);
  }
  return scans;
}

/// Straight ahead and back on the same line without turning, a pose each 0.1 m.
inline std::vector<Pose2> thereAndBack(int steps) {
  std::vector<Pose2> poses;
  for (int i = 0; i <= steps; ++i) poses.push_back({0.1 * i, 0.0, 0.0});
  for (int i = steps - 1; i >= 0; --i) poses.push_back({0.1 * i, 0.0, 0.0});
  return poses;
}

/// The same with odometry that drifts to the left.
inline std::vector<Pose2> withDrift(const std::vector<Pose2>& truth, double drift_m) {
  std::vector<Pose2> odometry;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    odometry.push_back(truth[i]);
    odometry.back().y_m += drift_m * static_cast<double>(i) / static_cast<double>(truth.size());
  }
  return odometry;
}

/// Key scans without readings along a straight path, each so far from the one before.
inline std::vector<KeyScan> blindKeyScans(std::size_t count, double step_m) {
  std::vector<KeyScan> keys(count);
  for (std::size_t i = 0; i < count; ++i) {
    keys[i].stamp_ns = static_cast<std::int64_t>(i);
    keys[i].path_m = step_m * static_cast<double>(i);
    keys[i].map_from_laser.x_m = keys[i].path_m;
    keys[i].odom_from_laser = keys[i].map_from_laser;
  }
  return keys;
}

}  // namespace ram_slam
