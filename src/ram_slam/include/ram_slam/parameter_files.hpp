// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_parameters/parameter_file.hpp"

namespace ram_slam {

/// The shipped parameter files of this package's nodes, with every parameter at its default.
std::vector<ram_parameters::ParameterFile> parameterFiles();

}  // namespace ram_slam
