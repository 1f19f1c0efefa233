// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge.hpp"

#include "require_within.hpp"

namespace ramscout_feature_detector {

void EdgeDetectorParameters::validate() const {
  requireWithin("laser_range_sigma", laser_range_sigma, 1e-4, 1.0);
  requireWithin("distance_threshold", distance_threshold, 0.01, 10.0);
  requireWithin("object_size", object_size, 0.0, 2.0);
  requireWithin("bend_scale", bend_scale, 0.02, 2.0);
  requireWithin("bend_angle", bend_angle, 0.1, M_PI);
  requireWithin("significance_min", significance_min, 0.0, 1e6);
  requireWithin("position_sigma_limit", position_sigma_limit, 1e-4, 10.0);
  requireWithin("feature_distance", feature_distance, 0.01, 10.0);
  requireWithin("max_features", max_features, 1, 1000);
  requireFrame("base_frame", base_frame);
}

EdgeDetectorParameters readEdgeDetectorParameters(ram_parameters::ParameterReader& reader) {
  EdgeDetectorParameters parameters;
  reader.read("laser_range_sigma", parameters.laser_range_sigma);
  reader.read("distance_threshold", parameters.distance_threshold);
  reader.read("object_size", parameters.object_size);
  reader.read("bend_scale", parameters.bend_scale);
  reader.read("bend_angle", parameters.bend_angle);
  reader.read("significance_min", parameters.significance_min);
  reader.read("position_sigma_limit", parameters.position_sigma_limit);
  reader.read("feature_distance", parameters.feature_distance);
  reader.read("max_features", parameters.max_features);
  reader.read("base_frame", parameters.base_frame);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

}  // namespace ramscout_feature_detector
