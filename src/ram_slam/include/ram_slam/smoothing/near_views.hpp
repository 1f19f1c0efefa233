// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/smoothing/key_scan.hpp"

namespace ram_slam {

/// Which key scans of other passages see what a key scan sees. The table explains the fields.
struct NearViewParameters {
  int count = 4;
  double max_view_distance_m = 2.5;
  double max_angle_rad = 3.2;
  int min_loop_gap = 10;
  int min_passage_gap = 5;

  static const ram_parameters::ParameterTable<NearViewParameters>& table();
};

/// Earlier key scans of other passages whose view centres are nearest, the nearest first, one of
/// each passage.
/// \param source  index of the key scan, in the poses of now
/// \param accept  asked for each one in turn; those refused do not count
std::vector<std::size_t> nearViews(
    const std::vector<KeyScan>& key_scans,
    std::size_t source,
    const NearViewParameters& parameters,
    const std::function<bool(std::size_t)>& accept = [](std::size_t) { return true; });

}  // namespace ram_slam
