// SPDX-License-Identifier: BSD-3-Clause
#include "fast_slam_node_parameters.hpp"

#include <stdexcept>

#include "ram_parameters/require.hpp"

namespace ram_slam_ros {

void FastSlamNodeParameters::validate() const {
  using ram_parameters::require;
  if (feature_topics.empty()) {
    throw std::invalid_argument("node/feature_topics must name at least one topic");
  }
  require(output_period >= 0.0, "node/output_period", output_period, ">= 0");
  require(0.0 < checkpoint_period && checkpoint_period <= 3600.0, "node/checkpoint_period",
          checkpoint_period, "in (0, 3600]");
}

FastSlamNodeParameters readFastSlamNodeParameters(ram_parameters::ParameterReader& all) {
  FastSlamNodeParameters parameters;
  ram_parameters::ParameterReader reader = all.section("node");
  reader.read("map_frame", parameters.frames.map);
  reader.read("odom_frame", parameters.frames.odom);
  reader.read("base_frame", parameters.frames.base);
  reader.read("feature_topics", parameters.feature_topics);
  reader.read("use_scan", parameters.use_scan);
  reader.read("output_period", parameters.output_period);
  reader.read("initial_map", parameters.initial_map);
  reader.read("checkpoint_file", parameters.checkpoint_file);
  reader.read("checkpoint_period", parameters.checkpoint_period);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

}  // namespace ram_slam_ros
