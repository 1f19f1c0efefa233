// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ramscout_feature_detector {

/// Scans with the laser's pose from the lines ROBOTLASER1 and FLASER of a CARMEN log, for lasers
/// that see up to 30 m.
inline std::vector<std::pair<ram_slam::Pose2, ram_slam::LaserScan>> readCorrectedLog(
    const char* path) {
  std::vector<std::pair<ram_slam::Pose2, ram_slam::LaserScan>> log;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    ram_slam::Pose2 pose;
    ram_slam::LaserScan scan;
    int count = 0;
    if (name == "ROBOTLASER1") {
      double type, field_of_view, max_range, accuracy, remission;
      words >> type >> scan.angle_min_rad >> field_of_view >> scan.angle_increment_rad >>
          max_range >> accuracy >> remission >> count;
    } else if (name == "FLASER") {
      words >> count;
      scan.angle_min_rad = -M_PI_2;
      scan.angle_increment_rad = M_PI / (count < 200 ? 180.0 : 360.0);
    } else {
      continue;
    }
    scan.stamp_ns = 1;
    scan.range_min_m = 0.05F;
    scan.range_max_m = 30.0F;
    scan.ranges_m.resize(count);
    for (float& range_m : scan.ranges_m) words >> range_m;
    if (name == "ROBOTLASER1") {
      int remissions = 0;
      words >> remissions;
      for (double ignored; remissions > 0; --remissions) words >> ignored;
    }
    words >> pose.x_m >> pose.y_m >> pose.yaw_rad;
    if (words) log.push_back({pose, std::move(scan)});
  }
  return log;
}

}  // namespace ramscout_feature_detector
