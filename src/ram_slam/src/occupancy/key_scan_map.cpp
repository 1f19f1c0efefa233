// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/key_scan_map.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace ram_slam {
namespace {

/// What a scan moves when its pose changes, in the axes of the map.
Pose2 change(const Pose2& from, const Pose2& to) {
  const Eigen::Vector3d difference = componentDifference(to, from);
  return {difference.x(), difference.y(), difference.z()};
}

}  // namespace

KeyScanMap::KeyScanMap(const OccupancyMapperParameters& parameters, std::vector<PlacedScan> loaded)
    : parameters_(parameters), mapper_(parameters), loaded_(std::move(loaded)) {
  for (const PlacedScan& placed : loaded_)
    mapper_.add(placed.scan, placed.map_from_laser, placed.last_beam);
}

bool KeyScanMap::add(const LaserScan& scan,
                     const Pose2& map_from_base,
                     const Pose2& base_from_laser,
                     const Pose2& last_beam) {
  const Pose2 map_from_laser = map_from_base * base_from_laser;
  scan.validate();
  if (!map_from_laser.isFinite() || !last_beam.isFinite())
    throw std::invalid_argument("pose not finite");
  if (!scans_.empty()) {
    const KeyScan& last = scans_.back();
    if (scan.stamp_ns <= last.scan.stamp_ns) {
      throw std::invalid_argument("scan at " + std::to_string(scan.stamp_ns) +
                                  " ns is not later than the one before it");
    }
    const MotionGate key_scan{parameters_.key_distance_m, parameters_.key_angle_rad};
    if (!key_scan.isReachedBy(change(last.wanted.map_from_laser, map_from_laser))) return false;
  }
  scans_.push_back({scan, base_from_laser, {map_from_laser, last_beam}, std::nullopt});
  if (scans_.size() > static_cast<std::size_t>(parameters_.max_scan_count)) {
    BeamCounts counts;
    settled_count_ += draw(scans_.front(), counts, {}) ? 1 : 0;
    scans_.pop_front();
  }
  return true;
}

int KeyScanMap::correct(const Trajectory& map_from_base) {
  validate(map_from_base);
  int moved_count = 0;
  std::optional<Pose2> corrected_from_old;
  for (KeyScan& key : scans_) {
    const Pose2 before = key.wanted.map_from_laser;
    const std::optional<Pose2> base = poseAt(map_from_base, key.scan.stamp_ns);
    if (!base && !corrected_from_old) continue;
    const Pose2 corrected = base ? *base * key.base_from_laser : *corrected_from_old * before;
    if (base) corrected_from_old = corrected * before.inverse();
    const bool moves = parameters_.redraw.isReachedBy(change(before, corrected));
    moved_count += moves ? 1 : 0;
    if (key.drawn && !moves) continue;
    key.wanted.map_from_laser = corrected;
    const std::int64_t duration_ns = key.scan.duration_ns();
    if (duration_ns == 0) continue;  // all beams at once: nothing moves between them
    const auto base_then = poseAt(map_from_base, key.scan.stamp_ns + duration_ns);
    if (base && base_then)
      key.wanted.last_beam = corrected.inverse() * *base_then * key.base_from_laser;
  }
  return moved_count;
}

int KeyScanMap::removeAfter(std::int64_t stamp_ns) {
  int count = 0;
  while (!scans_.empty() && scans_.back().scan.stamp_ns > stamp_ns) {
    const KeyScan& key = scans_.back();
    if (key.drawn) mapper_.remove(key.scan, key.drawn->map_from_laser, key.drawn->last_beam);
    scans_.pop_back();
    ++count;
  }
  return count;
}

std::vector<PlacedScan> KeyScanMap::scans() const {
  std::vector<PlacedScan> all = loaded_;
  for (const KeyScan& key : scans_) {
    if (!key.drawn) continue;
    all.push_back({key.scan, key.base_from_laser, key.drawn->map_from_laser, key.drawn->last_beam});
  }
  return all;
}

BeamCounts KeyScanMap::draw(const DrawFailure& onFailure) {
  BeamCounts counts;
  const auto forgotten = std::remove_if(
      scans_.begin(), scans_.end(), [&](KeyScan& key) { return !draw(key, counts, onFailure); });
  scans_.erase(forgotten, scans_.end());
  return counts;
}

bool KeyScanMap::draw(KeyScan& key, BeamCounts& counts, const DrawFailure& onFailure) {
  if (key.drawn &&
      !parameters_.redraw.isReachedBy(change(key.drawn->map_from_laser, key.wanted.map_from_laser)))
    return true;
  try {
    // First, so that the scan is lost nowhere if the map cannot grow.
    const BeamCounts added = mapper_.add(key.scan, key.wanted.map_from_laser, key.wanted.last_beam);
    if (key.drawn) {
      mapper_.remove(key.scan, key.drawn->map_from_laser, key.drawn->last_beam);
    } else {
      counts.hit += added.hit;
      counts.cleared += added.cleared;
      counts.too_close += added.too_close;
      counts.invalid += added.invalid;
    }
    key.drawn = key.wanted;
  } catch (const std::exception& error) {
    if (onFailure) onFailure(key.scan.stamp_ns, error);
    if (key.drawn) key.wanted = *key.drawn;
  }
  return key.drawn.has_value();
}

}  // namespace ram_slam
