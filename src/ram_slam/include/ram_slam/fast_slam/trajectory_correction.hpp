// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/path.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {

/// Where a corrected trajectory moves things that were placed from the robot's pose at a stamp.
class TrajectoryCorrection {
public:
  /// \param path  map_from_base as it was believed; not empty
  /// \param corrected  the same corrected; not empty, in a frame of its own
  /// \param loaded_frame  of a loaded map: the corrected trajectory is in its frame, as far as this
  /// \throws std::invalid_argument if they have no stamp in common, or the corrected one is not in
  /// the loaded map's frame
  TrajectoryCorrection(Trajectory path,
                       const Trajectory& corrected,
                       const std::optional<MotionGate>& loaded_frame);

  /// That of the last pose at or before the stamp.
  const Pose2& newFromOld(std::int64_t stamp_ns) const;
  /// That of the pose that placed the landmark; the identity if a loaded map had it.
  Pose2 ofLandmark(const LandmarkRecord& record) const;
  Path correctedPath() const;
  const Pose2& mapFromCorrected() const { return map_from_corrected_; }
  /// The corrected trajectory, seen from the map.
  Trajectory inMap(Trajectory corrected) const;

private:
  Trajectory path_;
  std::vector<Pose2> new_from_old_;
  Pose2 map_from_corrected_;
  bool is_map_loaded_ = false;
};

}  // namespace ram_slam
