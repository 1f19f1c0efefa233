// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_reader.hpp"

namespace ram_parameters_ros {

/// The calling node's private parameters, as they are on the parameter server now, named by the
/// node in errors. \throws std::invalid_argument if a value has a type that YAML does not have
/// (binary, date)
ram_parameters::ParameterReader privateParameters();

}  // namespace ram_parameters_ros
