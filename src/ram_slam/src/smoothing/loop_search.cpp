// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/loop_search.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {

const ram_parameters::ParameterTable<DenseSearchParameters>& DenseSearchParameters::table() {
  using namespace ram_parameters;
  using P = DenseSearchParameters;
  static const auto table =
      ParameterTable<P>()
          .expert("Dense search for a loop")
          .add("resolution_m", &P::resolution_m, "m", positive(), "Side of a cell.")
          .add("reading_deviation_m", &P::reading_deviation_m, "m", positive(),
               "Standard deviation of a reading.")
          .add("levels", &P::levels, "", within(1, 10), "Levels of the likelihood pyramid.")
          .add("max_range_m", &P::max_range_m, "m", positive(),
               "Readings beyond are not used: they cross several cells per step of the angle.")
          .add("query_point_count", &P::query_point_count, "", atLeast(1),
               "About so many points are searched for.")
          .add("angle_step_rad", &P::angle_step_rad, "rad", positive(), "Step of the angle.")
          .add("reserve_m", &P::reserve_m, "m", atLeast(0.0),
               "Shift that is searched even without drift, to each side.")
          .add("reserve_rad", &P::reserve_rad, "rad", atLeast(0.0),
               "Turn that is searched even without drift, to each side.");
  return table;
}

const ram_parameters::ParameterTable<CorridorTestParameters>& CorridorTestParameters::table() {
  using namespace ram_parameters;
  using P = CorridorTestParameters;
  static const auto table =
      ParameterTable<P>()
          .expert("Corridor test of a loop")
          .add("min_crossing_sine", &P::min_crossing_sine, "", within(0.0, 1.0),
               "Least sine of the angle between a direction and a wall whose points fix it.")
          .add("min_crossing_points", &P::min_crossing_points, "", atLeast(1),
               "With fewer such points a place is ambiguous along the direction.")
          .add("min_rival_shift_m", &P::min_rival_shift_m, "m", positive(),
               "Least shift at which the place is compared with itself.")
          .add("max_rival_score", &P::max_rival_score, "", within(0.0, 1.0),
               "Share of the best score above which a shifted pose makes the place ambiguous.");
  return table;
}

const ram_parameters::ParameterTable<LoopSearchParameters>& LoopSearchParameters::table() {
  using namespace ram_parameters;
  using P = LoopSearchParameters;
  static const auto table =
      ParameterTable<P>()
          .add("min_path_m", &P::min_path_m, "m", positive(),
               "Least path between two key scans of a loop, the shortest way through the graph.")
          .add("max_view_distance_m", &P::max_view_distance_m, "m", positive(),
               "Greatest distance between the centres of what two scans see; drift comes on top.")
          .add("drift_m_per_m", &P::drift_m_per_m, "m/m", atLeast(0.0),
               "Drift of the position that is expected along the path.")
          .add("drift_rad_per_m", &P::drift_rad_per_m, "rad/m", atLeast(0.0),
               "Drift of the heading that is expected along the path.")
          .add("max_distance_m", &P::max_distance_m, "m", positive(),
               "Greatest shift that is searched, to each side.")
          .add("max_angle_rad", &P::max_angle_rad, "rad", positive(),
               "Greatest turn that is searched, to each side.")
          .add("neighbour_count", &P::neighbour_count, "", atLeast(0),
               "Key scans on each side that help to recognise a place.")
          .add("max_neighbour_count", &P::max_neighbour_count, "", atLeast(0),
               "The same where they see few points.")
          .add("min_points", &P::min_points, "", atLeast(1),
               "Points that they see together, without which no place is recognised.")
          .heading("Checks of a loop: all must hold")
          .add("min_score", &P::min_score, "", within(0.0, 1.0),
               "Least mean likelihood of the best pose in the dense search.")
          .add("min_inlier_ratio", &P::min_inlier_ratio, "", within(0.0, 1.0),
               "Least share of a scan's points that meet a surface of the other place.")
          .add("max_free_space_ratio", &P::max_free_space_ratio, "", within(0.0, 1.0),
               "Greatest share of points where the other place was seen to be free.")
          .add("max_round_trip_m", &P::max_round_trip_m, "m", positive(),
               "Greatest distance between matching there and matching back.")
          .add("max_round_trip_rad", &P::max_round_trip_rad, "rad", positive(),
               "Greatest turn between matching there and matching back.")
          .expert("Verification of a loop")
          .add("free_space_margin_m", &P::free_space_margin_m, "m", atLeast(0.0),
               "A point is in free space so far in front of what was seen in its direction.")
          .add("prior_information", &P::prior_information, "1/m^2, 1/rad^2", positive(),
               "Information of the pose that the dense search found, where walls leave it open.")
          .include(&P::dense, DenseSearchParameters::table())
          .include(&P::corridor, CorridorTestParameters::table());
  return table;
}

std::vector<std::size_t> findLoopCandidates(const std::vector<KeyScan>& key_scans,
                                            std::size_t newest,
                                            const std::vector<double>& path_to_m,
                                            const LoopSearchParameters& parameters) {
  struct Candidate {
    std::size_t index;
    double distance_m;  // beyond what drift explains
  };
  const Eigen::Vector2d centre = key_scans[newest].viewCentreInMap();
  std::vector<Candidate> best_of_passage;
  bool in_passage = false;
  for (std::size_t i = 0; i < newest; ++i) {
    const double allowed_m =
        parameters.max_view_distance_m +
        std::min(parameters.max_distance_m, parameters.drift_m_per_m * path_to_m[i]);
    const double distance_m = (key_scans[i].viewCentreInMap() - centre).norm();
    if (std::isinf(path_to_m[i]) || path_to_m[i] < parameters.min_path_m ||
        distance_m > allowed_m) {
      in_passage = false;
      continue;
    }
    if (!in_passage) {
      best_of_passage.push_back({i, distance_m});
    } else if (distance_m < best_of_passage.back().distance_m) {
      best_of_passage.back() = {i, distance_m};
    }
    in_passage = true;
  }
  std::stable_sort(
      best_of_passage.begin(), best_of_passage.end(),
      [](const Candidate& a, const Candidate& b) { return a.distance_m < b.distance_m; });
  std::vector<std::size_t> indices;
  for (const Candidate& candidate : best_of_passage) indices.push_back(candidate.index);
  return indices;
}

SearchWindow searchWindow(double path_m, const LoopSearchParameters& parameters) {
  SearchWindow window;
  window.distance_m = std::min(parameters.max_distance_m,
                               parameters.dense.reserve_m + parameters.drift_m_per_m * path_m);
  window.angle_rad = std::min(parameters.max_angle_rad,
                              parameters.dense.reserve_rad + parameters.drift_rad_per_m * path_m);
  window.angle_step_rad = parameters.dense.angle_step_rad;
  return window;
}

NearestView nearestView(const std::vector<KeyScan>& key_scans,
                        const Eigen::Vector2d& place_m,
                        double max_path_m) {
  NearestView nearest;
  for (std::size_t i = 0; i < key_scans.size() && key_scans[i].path_m <= max_path_m; ++i) {
    const double distance_m = (key_scans[i].viewCentreInMap() - place_m).norm();
    if (distance_m < nearest.distance_m) nearest = {i, distance_m};
  }
  return nearest;
}

}  // namespace ram_slam
