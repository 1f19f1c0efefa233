// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_table.hpp"

namespace ram_slam {

/// Reads what a landmark filter has in the file of its estimator, and leaves the sections `node`
/// and `relocalisation` to others.
/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
template <typename Parameters>
Parameters readFilterParameters(ram_parameters::ParameterReader& reader) {
  Parameters parameters;
  Parameters::table().read(reader, parameters);
  reader.has("node");
  reader.has("relocalisation");
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

}  // namespace ram_slam
