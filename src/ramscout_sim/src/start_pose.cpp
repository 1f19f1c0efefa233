// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/start_pose.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace ramscout_sim {
namespace {

std::string text(const Pose2& pose) {
  return "[" + std::to_string(pose.x_m) + ", " + std::to_string(pose.y_m) + ", " +
         std::to_string(pose.yaw_rad) + "]";
}

}  // namespace

std::optional<Pose2> nearestFreePose(const RobotDescription& robot,
                                     const World& world,
                                     const Pose2& wanted,
                                     const PhysicsParameters& parameters) {
  const Eigen::Vector3d outside = boundsOf(world).max() + Eigen::Vector3d::Constant(20.0);
  Physics physics(robot, world, {outside.x(), outside.y(), 0.0}, parameters);
  for (int ring = 0; ring <= parameters.start_rings; ++ring) {
    const double radius_m = ring * parameters.start_ring_m;
    const int places = ring == 0 ? 1 : std::min(64, 8 * ring);
    for (int place = 0; place < places; ++place) {
      const double angle_rad = 2.0 * M_PI * place / places;
      const Pose2 candidate{wanted.x_m + radius_m * std::cos(angle_rad),
                            wanted.y_m + radius_m * std::sin(angle_rad), wanted.yaw_rad};
      try {
        physics.setPose(candidate);
        return candidate;
      } catch (const std::invalid_argument&) {
        continue;  // a solid is there, too
      }
    }
  }
  return std::nullopt;
}

Physics startedPhysics(const RobotDescription& robot,
                       const World& world,
                       const PhysicsParameters& parameters) {
  try {
    return {robot, world, world.start, parameters};
  } catch (const std::invalid_argument& error) {
    const std::optional<Pose2> free = nearestFreePose(robot, world, world.start, parameters);
    throw std::invalid_argument("start " + text(world.start) + ": " + error.what() +
                                (free ? "; free is " + text(*free) : ", and so it is all around"));
  }
}

}  // namespace ramscout_sim
