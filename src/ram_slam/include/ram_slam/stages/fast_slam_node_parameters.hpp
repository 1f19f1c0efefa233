// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/stages/estimator_stage.hpp"

namespace ram_slam {

/// Names of the frames between which the node publishes poses.
struct Frames {
  std::string map = "map";
  std::string odom = "odom";
  std::string base = "base_link";

  static const ram_parameters::ParameterTable<Frames>& table();
};

/// What only the node of an estimator needs; the section `node` of config/fast_slam.yaml.
struct FastSlamNodeParameters {
  std::string estimator = "fast_slam";
  Frames frames;
  std::vector<std::string> feature_topics = {"features"};
  bool use_scan = true;
  double output_period = 1.0;      ///< [s]
  std::string initial_map;         ///< file of a world map; empty: none
  std::string checkpoint_file;     ///< empty: no checkpoints
  double checkpoint_period = 2.0;  ///< [s]
  EstimatorStageParameters readings;

  static const ram_parameters::ParameterTable<FastSlamNodeParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads the section `node`. \throws std::invalid_argument for an unknown key, a wrong type or a
/// value out of bounds
FastSlamNodeParameters readFastSlamNodeParameters(ram_parameters::ParameterReader& all);

}  // namespace ram_slam
