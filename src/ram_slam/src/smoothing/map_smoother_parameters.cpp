// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_smoother.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<MapSmootherParameters>& MapSmootherParameters::table() {
  using namespace ram_parameters;
  using P = MapSmootherParameters;
  static const auto table =
      ParameterTable<P>()
          .add("map_frame", &P::map_frame, "Frame of the corrected trajectory.")
          .add("base_frame", &P::base_frame, "Frame of the robot's base.")
          .add("initial_map", &P::initial_map,
               "Saved map (folder, or a file in it, of the service save_map of world_map) to "
               "continue, once the robot is found in it; empty: none. (docs/maps.md)")
          .add("optimize_period_s", &P::optimize_period_s, "s", atLeast(0.0),
               "Least time between two optimizations, by the stamps of the scans; 0: only at "
               "closures that move the robot and on request.")
          .include(&P::surfaces, SurfaceParameters::table())
          .include(&P::matcher, ScanMatcherParameters::table())
          .include(&P::key_scans, KeyScanParameters::table())
          .include(&P::loops, LoopCloserParameters::table())
          .heading("Pose graph")
          .include(&P::graph, PoseGraphParameters::table())
          .heading("Alignment of all key scans with each other")
          .include(&P::refinement, RefinementParameters::table(), "refinement_")
          .expert("Corrections")
          .add("solve_distance_m", &P::solve_distance_m, "m", atLeast(0.0),
               "A closure that moves its later key scan farther is solved for at once.")
          .add("solve_angle_rad", &P::solve_angle_rad, "rad", atLeast(0.0),
               "A closure that turns its later key scan by more is solved for at once.")
          .add("correction_distance_m", &P::correction_distance_m, "m", atLeast(0.0),
               "The trajectory is published if such a closure moved the newest pose farther.")
          .add("correction_angle_rad", &P::correction_angle_rad, "rad", atLeast(0.0),
               "The trajectory is published if such a closure turned the newest pose by more.")
          .add("max_sweeps", &P::max_sweeps, "", atLeast(0),
               "Most searches for loops along the whole path per optimization.")
          .add("max_published_poses", &P::max_published_poses, "", atLeast(100),
               "Most poses in a message on smoothed_trajectory; of more, the older ones are "
               "thinned out.");
  return table;
}

MapSmootherParameters readMapSmootherParameters(ram_parameters::ParameterReader& reader) {
  return MapSmootherParameters::table().readAll(reader);
}

}  // namespace ram_slam
