// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_parameters/parameter_file.hpp"

namespace ramscout_sim {

/// The parameter files that this package ships: simulator.yaml.
std::vector<ram_parameters::ParameterFile> parameterFiles();

}  // namespace ramscout_sim
