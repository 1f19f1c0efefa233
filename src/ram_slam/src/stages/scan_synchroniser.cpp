// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/stages/scan_synchroniser.hpp"

#include <utility>

#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {

void ScanSynchroniser::add(MountedScan scan) {
  const std::int64_t stamp_ns = scan.scan.stamp_ns;
  if (!scan.base_from_laser.isFinite()) {
    drops_.add(DropReason::kInvalidScan, stamp_ns, "the laser's mount is not finite");
    return;
  }
  switch (scan_clock_.check(stamp_ns)) {
    case StampOrder::kNotLater:
      drops_.add(DropReason::kNotLater, stamp_ns, "scan");
      return;
    case StampOrder::kSetBack:
      reset();
      break;
    case StampOrder::kLater:
      break;
  }
  scans_.push_back(std::move(scan));
}

bool ScanSynchroniser::add(const StampedPose2& odom_from_base) {
  if (!odom_from_base.pose.isUsable()) {
    drops_.add(DropReason::kInvalidOdometry, odom_from_base.stamp_ns,
               "a pose that is not finite or farther off than 10,000 km");
    return false;
  }
  switch (odometry_clock_.check(odom_from_base.stamp_ns)) {
    case StampOrder::kNotLater:
      drops_.add(DropReason::kNotLater, odom_from_base.stamp_ns, "odometry");
      return false;
    case StampOrder::kSetBack:
      odometry_.clear();
      break;
    case StampOrder::kLater:
      break;
  }
  odometry_.push_back(odom_from_base);
  if (odometry_.size() > parameters_.max_odometry_readings) odometry_.pop_front();
  return true;
}

void ScanSynchroniser::reset() {
  scans_.clear();
  const bool is_of_old_clock =
      !odometry_.empty() &&
      ClockGuard::isSetBack(odometry_.back().stamp_ns, scan_clock_.newest_ns());
  if (is_of_old_clock) odometry_.clear();
  ++reset_count_;
}

std::optional<SynchronisedScan> ScanSynchroniser::next() {
  using Odometry = ScanSynchroniserParameters::Odometry;
  while (!scans_.empty()) {
    const std::int64_t at_ns = scans_.front().scan.stamp_ns + stamp_offset_ns_;
    const bool is_reached = !odometry_.empty() && at_ns <= odometry_.back().stamp_ns;
    if (parameters_.odometry != Odometry::kNone && !is_reached && !isGivenUp()) return std::nullopt;
    SynchronisedScan ready;
    if (parameters_.odometry != Odometry::kNone) ready.odom_from_base = odometryAt(at_ns);
    ready.scan = std::move(scans_.front().scan);
    ready.base_from_laser = scans_.front().base_from_laser;
    scans_.pop_front();
    if (ready.odom_from_base || parameters_.odometry == Odometry::kNone) return ready;
    if (parameters_.odometry == Odometry::kOptional) {
      ++without_odometry_count_;
      return ready;
    }
    drops_.add(DropReason::kNoOdometry, ready.scan.stamp_ns, "scan");
  }
  return std::nullopt;
}

Trajectory ScanSynchroniser::odometryBetween(std::int64_t first_scan_ns,
                                             std::int64_t last_scan_ns) const {
  Trajectory between;
  for (const StampedPose2& reading : odometry_) {
    const std::int64_t stamp_ns = reading.stamp_ns - stamp_offset_ns_;
    if (stamp_ns > first_scan_ns && stamp_ns < last_scan_ns)
      between.push_back({stamp_ns, reading.pose});
  }
  return between;
}

bool ScanSynchroniser::isGivenUp() const {
  const std::int64_t wait_ns = scans_.back().scan.stamp_ns - scans_.front().scan.stamp_ns;
  return is_finished_ || scans_.size() > parameters_.max_waiting_scans ||
         static_cast<double>(wait_ns) > 1e9 * parameters_.max_wait_s;
}

std::optional<Pose2> ScanSynchroniser::odometryAt(std::int64_t at_ns) const {
  if (odometry_.empty() || at_ns < odometry_.front().stamp_ns) return std::nullopt;
  const StampedPose2& newest = odometry_.back();
  if (at_ns <= newest.stamp_ns) return ram_slam::odometryAt(odometry_, at_ns);
  const bool holds = static_cast<double>(at_ns - newest.stamp_ns) <= 1e9 * parameters_.max_hold_s;
  return holds ? std::optional(newest.pose) : std::nullopt;
}

}  // namespace ram_slam
