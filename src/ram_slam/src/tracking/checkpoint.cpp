// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/checkpoint.hpp"

#include <stdexcept>

#include "ram_slam/world_map/landmark_layer.hpp"
#include "ram_slam/world_map/world_map_file.hpp"

namespace ram_slam {
Trajectory thinned(const Trajectory& path, const MotionGate& step) {
  Trajectory kept;
  for (const StampedPose2& pose : path) {
    if (!kept.empty() && &pose != &path.back()) {
      const Pose2 moved = kept.back().pose.inverse() * pose.pose;
      if (!step.isReachedBy(moved)) continue;
    }
    kept.push_back(pose);
  }
  return kept;
}

std::string toBytes(const Checkpoint& checkpoint) {
  WorldMap world;
  world.put(toLandmarkLayer(checkpoint.map));
  world.put(checkpoint.path);
  return toBytes(world);
}

Checkpoint checkpointFromBytes(const std::string& bytes) {
  const WorldMap world = worldMapFromBytes(bytes);
  if (!world.occupancies().empty() || !world.clouds().empty() || !world.scans().empty())
    throw std::runtime_error("it is a stored world, not a checkpoint");
  Checkpoint checkpoint{toLandmarkMap(world.landmarks()), world.trajectory()};
  for (std::size_t i = 0; i < checkpoint.map.landmarks.size(); ++i)
    checkpoint.map.landmarks[i].placed_ns = world.landmarks().landmarks[i].stamp_ns;
  const std::int64_t stamp_ns = checkpoint.map.stamp_ns;
  if (stamp_ns <= 0) throw std::runtime_error("it holds no reading");
  if (!checkpoint.path.empty() && checkpoint.path.back().stamp_ns > stamp_ns)
    throw std::runtime_error("its path goes on after its last reading");
  return checkpoint;
}

}  // namespace ram_slam
