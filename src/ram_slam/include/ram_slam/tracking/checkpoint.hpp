// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"

namespace ram_slam {

/// What Tracker needs to go on after its process was ended.
struct Checkpoint {
  LandmarkMap map;  ///< its stamp is that of the last reading
  /// The robot's way. It ends at that stamp, or before if the robot was lost then.
  Trajectory path;

  bool isLost() const { return path.empty() || path.back().stamp_ns != map.stamp_ns; }
};

/// Leaves out poses of a path within a step of the one before, but for the last one.
Trajectory thinned(const Trajectory& path, const MotionGate& step);

/// As the bytes of a world map's file that holds landmarks and trajectory alone.
std::string toBytes(const Checkpoint& checkpoint);

/// What toBytes() wrote.
/// \throws std::runtime_error stating what is wrong: as worldMapFromBytes(), a world map with more
/// than a checkpoint has, no reading in it, or a path that goes on after it
Checkpoint checkpointFromBytes(const std::string& bytes);

}  // namespace ram_slam
