// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"
#include "ram_slam/stages/scan_synchroniser.hpp"
#include "ram_slam/stages/tracking_gate.hpp"

namespace ram_slam {

/// A scan was smoothed.
struct SmoothingStep {
  std::int64_t stamp_ns = 0;
  /// The trajectory of the base so far, if a loop closure or an optimisation moved it: the
  /// estimator follows it.
  std::optional<Trajectory> correction = {};
  /// The pose of the base as the map of now has it, in the frame of the trajectory, if the scan was
  /// aligned with it: the estimator is moved there.
  std::optional<Pose2> map_from_base = {};
};

/// From scans, odometry and features to a corrected trajectory: waits for the odometry of each
/// scan, and decides when to optimise and when to publish.
class SmoothingStage {
public:
  /// \param loaded  scans of a map made before; if there are any it is continued, in its frame,
  /// once the robot's place in it is known (set()) \throws std::invalid_argument as
  /// MapSmootherParameters::validate()
  SmoothingStage(const MapSmootherParameters& parameters,
                 const FeatureMatchers& matchers,
                 std::vector<PlacedScan> loaded = {});

  void add(MountedScan scan) { scans_.add(std::move(scan)); }
  void addOdometry(const StampedPose2& odom_from_base) { scans_.add(odom_from_base); }
  void addFeatures(const FeatureList& list) { smoother_.addFeatures(list); }

  /// The robot came to be lost, or was found. In a loaded map nothing is taken in before the robot
  /// was found there. After that scans are taken in whether the estimator is lost or not: that it
  /// is lost shows where the robot may have been carried; whether it was is decided by the scans
  /// (JumpSearch).
  void set(const Tracking& tracking);

  /// Takes in the next scan whose odometry is known; nothing if it still waits.
  std::optional<SmoothingStep> next();
  /// Optimises everything now. \return the trajectory
  Trajectory optimize();
  /// Refuses the newest accepted closure; optimize() then makes the trajectory without it.
  /// \return its index; nothing, and nothing changes, if there is none
  std::optional<std::size_t> undoClosure();

  const MapSmoother& smoother() const { return smoother_; }
  /// How often the clock was set back and everything began again.
  int resetCount() const { return scans_.resetCount(); }
  const DropCounter& drops() const { return scans_.drops(); }
  DropCounter& drops() { return scans_.drops(); }

private:
  MapSmootherParameters parameters_;
  FeatureMatchers matchers_;
  ScanSynchroniser scans_;
  /// Begins again: empty, or with the loaded map.
  void restart();
  /// Of the base in the frame of the smoothed trajectory, where odometry has it at a scan.
  Pose2 aligned(const Pose2& odom_from_base);

  std::vector<PlacedScan> loaded_;
  MapSmoother smoother_;
  TrackingGate gate_;
  std::optional<Tracking> found_;  ///< where it was found, until the next scan
  bool starts_session_ = false;    ///< at that place, in a loaded map
  Pose2 smoothed_from_odom_;
  int reset_count_ = 0;  ///< that smoother_ has followed
};

}  // namespace ram_slam
