// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_parameters/parameter_file.hpp"

namespace ramscout_feature_detector {

/// The parameter files that this package ships: feature_detector.yaml and edge_detector.yaml.
std::vector<ram_parameters::ParameterFile> parameterFiles();

}  // namespace ramscout_feature_detector
