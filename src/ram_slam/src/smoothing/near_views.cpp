// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/near_views.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ram_slam {

const ram_parameters::ParameterTable<NearViewParameters>& NearViewParameters::table() {
  using namespace ram_parameters;
  using P = NearViewParameters;
  static const auto table =
      ParameterTable<P>()
          .add("loop_neighbour_count", &P::count, "", atLeast(0),
               "Most key scans of other passages that each one is paired with.")
          .add("max_view_distance_m", &P::max_view_distance_m, "m", positive(),
               "Greatest distance between the centres of what two scans see.")
          .add("max_angle_rad", &P::max_angle_rad, "rad", positive(),
               "Greatest angle between the headings of two scans.")
          .expert("Pairs of key scans of different passages")
          .add("min_loop_gap", &P::min_loop_gap, "", atLeast(1),
               "Least number of key scans between one and another passage.")
          .add("min_passage_gap", &P::min_passage_gap, "", atLeast(1),
               "Least number of key scans between two other passages.");
  return table;
}

std::vector<std::size_t> nearViews(const std::vector<KeyScan>& key_scans,
                                   std::size_t source,
                                   const NearViewParameters& parameters,
                                   const std::function<bool(std::size_t)>& accept) {
  const auto loop_gap = static_cast<std::size_t>(parameters.min_loop_gap);
  const auto passage_gap = static_cast<std::size_t>(parameters.min_passage_gap);
  const Eigen::Vector2d centre = key_scans[source].viewCentreInMap();
  const auto distance2 = [&](const Eigen::Vector2d& place) {
    return (place - centre).squaredNorm();
  };
  const double max_m = parameters.max_view_distance_m;
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t target = 0; target + loop_gap <= source; ++target) {
    const KeyScan& key = key_scans[target];
    // Most are too far away for any direction of view, which spares the rotation.
    const double reach_m = max_m + key.view_centre_in_laser_m.norm();
    if (distance2(key.map_from_laser.translation()) > reach_m * reach_m) continue;
    const double squared = distance2(key.viewCentreInMap());
    if (squared > max_m * max_m) continue;
    const double turn =
        wrapAngle(key.map_from_laser.yaw_rad - key_scans[source].map_from_laser.yaw_rad);
    if (std::abs(turn) <= parameters.max_angle_rad) near.emplace_back(squared, target);
  }
  std::sort(near.begin(), near.end());

  std::vector<std::size_t> chosen;
  for (const auto& [squared, key] : near) {
    if (chosen.size() == static_cast<std::size_t>(parameters.count)) break;
    const bool is_other_passage =
        std::all_of(chosen.begin(), chosen.end(), [&, key = key](std::size_t other) {
          return (key > other ? key - other : other - key) >= passage_gap;
        });
    if (is_other_passage && accept(key)) chosen.push_back(key);
  }
  return chosen;
}

}  // namespace ram_slam
