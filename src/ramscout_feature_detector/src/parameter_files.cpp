// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/parameter_files.hpp"

#include "ramscout_feature_detector/edge.hpp"
#include "ramscout_feature_detector/parameters.hpp"

namespace ramscout_feature_detector {

std::vector<ram_parameters::ParameterFile> parameterFiles() {
  return {{"feature_detector.yaml", "ramscout_feature_detector/feature_detector",
           "Finds corners of straight walls. Numbers outside the range known to work are accepted "
           "with a warning, outside of the first range they are refused.",
           FeatureDetectorParameters::table().rows()},
          {"edge_detector.yaml", "ramscout_feature_detector/edge_detector",
           "Finds corners, ends of surfaces, bends and small free-standing things.",
           EdgeDetectorParameters::table().rows()}};
}

}  // namespace ramscout_feature_detector
