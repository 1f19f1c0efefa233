// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace ram_slam {

/// Why a stage did not use what it was given. The only list of reasons: the summary of a run and
/// /diagnostics both count by it.
enum class DropReason {
  kNotLater,           ///< its stamp is not later than that of the one before
  kOtherClock,         ///< its stamp is far from those before and after it
  kInvalidScan,        ///< geometry, stamp or mount of a scan is unusable
  kInvalidOdometry,    ///< a pose or stamp of odometry is unusable, or it jumped
  kInvalidFeatures,    ///< a feature list is unusable
  kInvalidTrajectory,  ///< a corrected trajectory cannot be followed
  kMapPoseAway,        ///< a pose measured in the smoother's map is far from the estimator's
  kNoOdometry,         ///< odometry did not reach the scan's stamp in time
  kNoMount,            ///< the sensor's pose on the robot is not known
  kNoMotion,           ///< the motion up to the stamp is not known
  kNoPose,             ///< the robot's pose in the map is not known at the stamp
  kQueueFull,          ///< more is waiting than can be used
  kMapFull,            ///< the map would grow beyond its size limit
  kPaused,             ///< the stage is paused
  kLost,               ///< the robot does not know where it was at the stamp
};

/// One line of plain English, without stamps or numbers, so that it can be a key.
std::string toText(DropReason reason);

/// What was dropped for one reason.
struct Drops {
  DropReason reason = DropReason::kNotLater;
  std::uint64_t count = 0;
  std::int64_t first_ns = 0;  ///< stamp of the first one
  std::int64_t last_ns = 0;   ///< stamp of the newest one
  std::string detail;         ///< of the newest one: what exactly was wrong
};

/// Counts what a stage drops, by reason. Nothing is dropped without being counted here.
class DropCounter {
public:
  void add(DropReason reason, std::int64_t stamp_ns, const std::string& detail = "");
  /// Adds what another one has counted.
  void add(const DropCounter& other);

  /// In the order of DropReason; reasons that never occurred are left out.
  std::vector<Drops> all() const;
  std::uint64_t total() const { return total_; }
  /// The newest one. \throws std::out_of_range if there is none
  const Drops& newest() const { return drops_.at(newest_); }

private:
  std::map<DropReason, Drops> drops_;
  DropReason newest_ = DropReason::kNotLater;
  std::uint64_t total_ = 0;
};

}  // namespace ram_slam
