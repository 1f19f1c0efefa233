// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "ramscout_bringup/results.hpp"

#include "scenario.hpp"

namespace ramscout_bringup {

struct Grade {
  std::map<std::string, double> figures;  ///< of all figureKinds()
  Results results;
};

/// Drives the scenario in simulation and maps it with the stages and settings of the live nodes.
/// All but CPU and memory is the same for every repetition.
/// \param config  the folder with the nodes' parameter files and the robot's description
/// \throws std::runtime_error or std::invalid_argument if a file or a fault is refused
Grade grade(const Scenario& scenario, const std::string& config, int seed);

}  // namespace ramscout_bringup
