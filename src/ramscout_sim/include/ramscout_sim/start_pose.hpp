// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "ramscout_sim/physics.hpp"

namespace ramscout_sim {

/// A pose with the same heading at which the robot stands free, on the nearest ring around the
/// wanted one (PhysicsParameters::start_ring_m, start_rings: at most 10 m away).
std::optional<Pose2> nearestFreePose(const RobotDescription& robot,
                                     const World& world,
                                     const Pose2& wanted,
                                     const PhysicsParameters& parameters = {});

/// Physics with the robot at the world's start. \throws std::invalid_argument if it would stand
/// inside a solid, naming the nearest free pose
Physics startedPhysics(const RobotDescription& robot,
                       const World& world,
                       const PhysicsParameters& parameters = {});

}  // namespace ramscout_sim
