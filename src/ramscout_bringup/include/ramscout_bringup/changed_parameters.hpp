// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "ram_parameters/parameter_file.hpp"

namespace ramscout_bringup {

/// A parameter with another value than its default.
struct ChangedParameter {
  std::string file;           ///< e.g. "fast_slam.yaml"
  std::string key;            ///< with its sections: "relocalisation/window"
  std::string value;          ///< as YAML
  std::string default_value;  ///< likewise
  std::string unit;           ///< empty: none
};

/// What differs from the defaults of a node's parameter file.
/// \param values  the map that a node reads; null: nothing differs
std::vector<ChangedParameter> changedParameters(const YAML::Node& values,
                                                const ram_parameters::ParameterFile& file);

}  // namespace ramscout_bringup
