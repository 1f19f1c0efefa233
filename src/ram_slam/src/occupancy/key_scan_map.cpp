// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/key_scan_map.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace ram_slam {
namespace {

/// Corrections smaller than these leave a scan where it is: they would not move it by a fraction of
/// a cell.
constexpr double kNegligibleM = 0.002;
constexpr double kNegligibleRad = 0.0005;

bool differ(const Pose2& a, const Pose2& b, double distance_m, double angle_rad) {
  return (a.translation() - b.translation()).norm() >= distance_m ||
         std::abs(wrapAngle(a.yaw_rad - b.yaw_rad)) >= angle_rad;
}

}  // namespace

KeyScanMap::KeyScanMap(const OccupancyMapperParameters& parameters)
    : parameters_(parameters), mapper_(parameters) {}

std::optional<BeamCounts> KeyScanMap::add(const LaserScan& scan,
                                          const Pose2& map_from_base,
                                          const Pose2& base_from_laser,
                                          const Pose2& last_beam) {
  const Pose2 map_from_laser = map_from_base * base_from_laser;
  if (!scans_.empty()) {
    const KeyScan& last = scans_.back();
    if (scan.stamp_ns <= last.scan.stamp_ns) {
      throw std::invalid_argument("scan at " + std::to_string(scan.stamp_ns) +
                                  " ns is not later than the one before it");
    }
    if (!differ(map_from_laser, last.map_from_laser, parameters_.key_distance_m,
                parameters_.key_angle_rad)) {
      return std::nullopt;
    }
  }
  const BeamCounts counts = mapper_.add(scan, map_from_laser, last_beam);
  scans_.push_back({scan, base_from_laser, map_from_laser, last_beam});
  if (scans_.size() > static_cast<std::size_t>(parameters_.max_scan_count)) {
    scans_.pop_front();
    ++settled_count_;
  }
  return counts;
}

int KeyScanMap::correct(const Trajectory& map_from_base) {
  validate(map_from_base);
  int moved_count = 0;
  std::optional<Pose2> corrected_from_old;
  for (KeyScan& key : scans_) {
    const std::optional<Pose2> base = poseAt(map_from_base, key.scan.stamp_ns);
    if (!base && !corrected_from_old) continue;
    const Pose2 corrected =
        base ? *base * key.base_from_laser : *corrected_from_old * key.map_from_laser;
    if (base) corrected_from_old = corrected * key.map_from_laser.inverse();
    if (!differ(corrected, key.map_from_laser, kNegligibleM, kNegligibleRad)) continue;
    // First, so that the scan is lost nowhere if the map cannot grow.
    mapper_.add(key.scan, corrected, key.last_beam);
    mapper_.remove(key.scan, key.map_from_laser, key.last_beam);
    key.map_from_laser = corrected;
    ++moved_count;
  }
  return moved_count;
}

}  // namespace ram_slam
