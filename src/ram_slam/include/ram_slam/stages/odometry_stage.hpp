// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "ram_slam/calibration/mirror_check.hpp"
#include "ram_slam/calibration/stamp_offset.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/scan_matching/laser_odometry.hpp"
#include "ram_slam/stages/scan_synchroniser.hpp"

namespace ram_slam {

/// A scan and the odometry that was refined by it, or the wheels' pose as it is.
struct OdometryStep {
  MountedScan scan;  ///< corrected by what was learned of the lidar
  LaserOdometryEstimate estimate;
  /// Where the wheels lead from the scan before to this one, if it came long after that.
  Trajectory between = {};
};

/// From wheels and scans to refined odometry: waits for the wheels around each scan, aligns the
/// scan, and learns the offset between their stamps and the wheels' bias.
class OdometryStage {
public:
  /// \param refines  false: scans only wait for the wheels, which pass as they are
  /// \throws std::invalid_argument as LaserOdometryParameters::validate()
  explicit OdometryStage(const LaserOdometryParameters& parameters, bool refines = true);

  void add(MountedScan scan) { scans_.add(std::move(scan)); }
  /// \return whether the reading is used
  bool addWheels(const StampedPose2& odom_from_base);
  /// No wheels come any more: next() deals with all scans that still wait.
  void finish() { scans_.finish(); }

  /// The next scan whose wheels are known; nothing if it still waits.
  std::optional<OdometryStep> next();

  bool hasWheels() const { return scans_.hasOdometry(); }
  /// Of the last scan; 0 before the first.
  std::int64_t lastStamp_ns() const { return last_.stamp_ns; }
  /// Learned so far about the lidar.
  const LidarCalibration& lidarCalibration() const { return odometry_.lidarCalibration(); }
  /// Learned so far: how much later than a scan's stamp its wheels are taken.
  std::int64_t stampOffset_ns() const { return stamp_offset_.offset_ns(); }
  /// Scans that waited for the wheels and were aligned without them.
  std::size_t withoutWheelsCount() const { return scans_.withoutOdometryCount(); }
  /// Scans that contradicted the wheels.
  std::size_t slipCount() const { return slip_count_; }
  /// Whether wheels and scans turn against each other.
  bool isMirrored() const { return mirror_check_.isMirrored(); }
  /// How often the clock was set back and everything began again.
  int resetCount() const { return scans_.resetCount(); }
  const DropCounter& drops() const { return scans_.drops(); }
  DropCounter& drops() { return scans_.drops(); }

private:
  OdometryStep refine(SynchronisedScan ready);
  /// Takes the wheels of the last scan at the offset of now, too, so that a changed offset is no
  /// motion.
  void followStampOffset();
  /// The poses by the wheels since the last scan, moved so that they end at this estimate.
  Trajectory posesBetween(const LaserOdometryEstimate& estimate,
                          const std::optional<Pose2>& odom_from_base) const;
  void learnStampOffset(const LaserOdometryEstimate& estimate);

  LaserOdometryParameters parameters_;
  bool refines_;
  ScanSynchroniser scans_;
  LaserOdometry odometry_;
  StampOffset stamp_offset_;
  MirrorCheck mirror_check_;
  StampedPose2 last_;                ///< estimate
  std::int64_t last_offset_ns_ = 0;  ///< by which the last scan's wheels were taken
  std::size_t slip_count_ = 0;
  int reset_count_ = 0;  ///< that odometry_ has followed
};

}  // namespace ram_slam
