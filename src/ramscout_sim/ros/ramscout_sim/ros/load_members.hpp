// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ramscout_sim/fleet.hpp"
#include "ramscout_sim/simulator_node_parameters.hpp"

namespace ramscout_sim_ros {

/// The robots as their files, or the parameter robot_description, describe them; the noise of robot
/// i has the seed `seed` + i.
std::vector<ramscout_sim::FleetMember> loadMembers(
    const ramscout_sim::SimulatorNodeParameters& parameters, const ramscout_sim::World& world);

}  // namespace ramscout_sim_ros
