// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/sensing/laser_scan.hpp"
#include "ram_slam/stages/clock_guard.hpp"
#include "ram_slam/stages/drop_counter.hpp"

namespace ram_slam {

/// A scan, and where the laser was mounted when it was taken.
struct MountedScan {
  LaserScan scan;
  Pose2 base_from_laser;
};

/// A scan with the odometry at its stamp.
struct SynchronisedScan {
  LaserScan scan;
  Pose2 base_from_laser;
  std::optional<Pose2> odom_from_base;  ///< none if it is not known
};

/// How a ScanSynchroniser waits.
struct ScanSynchroniserParameters {
  /// What a scan waits for.
  enum class Odometry {
    kNone,      ///< nothing: scans go through without odometry
    kOptional,  ///< odometry, but goes through without it when that does not come
    kRequired,  ///< odometry, and is dropped without it
  };
  Odometry odometry = Odometry::kOptional;
  /// A scan is given up when so many newer ones wait behind it ...
  std::size_t max_waiting_scans = 100;
  /// ... or one so much newer.
  double max_wait_s = 10.0;
  /// Odometry after its end stands for so long still.
  double max_hold_s = 0.5;
  /// Readings of odometry that are kept; 20 s at 100 Hz.
  std::size_t max_odometry_readings = 2000;
};

/// Holds scans back until the odometry reaches their stamps. Scans and odometry each arrive in the
/// order of their stamps; what does not is dropped and counted.
class ScanSynchroniser {
public:
  explicit ScanSynchroniser(const ScanSynchroniserParameters& parameters)
      : parameters_(parameters) {}

  void add(MountedScan scan);
  /// \return whether it is used
  bool add(const StampedPose2& odom_from_base);
  /// From now on the odometry is taken so much later than the scan's stamp.
  void setStampOffset(std::int64_t offset_ns) { stamp_offset_ns_ = offset_ns; }
  std::int64_t stampOffset_ns() const { return stamp_offset_ns_; }
  /// The odometry that belongs to a scan of this stamp by the offset of now; none if it is not
  /// kept.
  std::optional<Pose2> odometryOf(std::int64_t scan_stamp_ns) const {
    return odometryAt(scan_stamp_ns + stamp_offset_ns_);
  }
  /// The readings of odometry that are kept from between two scans, on the clock of the scans.
  Trajectory odometryBetween(std::int64_t first_scan_ns, std::int64_t last_scan_ns) const;

  /// The next scan that is complete or given up; nothing if it still waits.
  std::optional<SynchronisedScan> next();
  /// No odometry comes any more: next() gives all that still waits.
  void finish() { is_finished_ = true; }

  /// How often the clock was set back, by the stamps of scans or odometry: whoever keeps a state
  /// from scan to scan begins again when it changes.
  int resetCount() const { return reset_count_; }
  bool hasOdometry() const { return !odometry_.empty(); }
  /// Scans that waited for odometry and went through without it.
  std::size_t withoutOdometryCount() const { return without_odometry_count_; }
  const DropCounter& drops() const { return drops_; }
  DropCounter& drops() { return drops_; }

private:
  /// Forgets all that belongs to the clock before.
  void reset();
  bool isGivenUp() const;
  /// \param at_ns  on the odometry's clock
  std::optional<Pose2> odometryAt(std::int64_t at_ns) const;

  ScanSynchroniserParameters parameters_;
  std::deque<MountedScan> scans_;
  std::deque<StampedPose2> odometry_;
  ClockGuard scan_clock_;
  ClockGuard odometry_clock_;
  std::int64_t stamp_offset_ns_ = 0;
  bool is_finished_ = false;
  int reset_count_ = 0;
  std::size_t without_odometry_count_ = 0;
  DropCounter drops_;
};

}  // namespace ram_slam
