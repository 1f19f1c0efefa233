// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_reader.hpp"
#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/fast_slam/parameters.hpp"

namespace ram_slam {

/// Settings of EkfSlam: config/ekf_slam.yaml.
struct EkfSlamParameters {
  FastSlamParameters common;  ///< of which FastSlamParameters::landmarkTable() counts
  int max_landmarks = 1500;

  static const ram_parameters::ParameterTable<EkfSlamParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// Reads every key of EkfSlamParameters; the sections `node` and `relocalisation` are left to their
/// readers. \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
EkfSlamParameters readEkfSlamParameters(ram_parameters::ParameterReader& reader);

}  // namespace ram_slam
