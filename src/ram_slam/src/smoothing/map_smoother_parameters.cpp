// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_smoother.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<KeyScanParameters>& KeyScanParameters::table() {
  using namespace ram_parameters;
  using P = KeyScanParameters;
  static const auto table =
      ParameterTable<P>()
          .heading("Key scans")
          .add("key_scan_distance_m", &P::distance_m, "m", positive(),
               "A new key scan is taken after so much motion.")
          .add("key_scan_angle_rad", &P::angle_rad, "rad", positive(),
               "A new key scan is taken after so much turning.")
          .heading("Given motion between two key scans, where the scans do not measure it better")
          .include(&P::motion_noise, MotionNoise::table(), "motion_")
          .heading("Alignment of successive key scans beyond what the noise of the scans explains")
          .add("match_deviation_m", &P::match_deviation_m, "m", positive(),
               "Standard deviation of the position, per axis.")
          .add("match_deviation_rad", &P::match_deviation_rad, "rad", positive(),
               "Standard deviation of the heading.")
          .expert("Choice and alignment of key scans")
          .add("jump_gap_s", &P::jump_gap_s, "s", positive(),
               "Where scans are missing for longer the robot may have been carried.")
          .add("jump_inlier_ratio", &P::jump_inlier_ratio, "", within(0.0, 1.0),
               "The same where a smaller share of a key scan meets those before, ...")
          .add("jump_key_scans", &P::jump_key_scans, "", atLeast(1),
               "... and of those after it, so many in a row.")
          .add("jump_deviation_m", &P::jump_deviation_m, "m", positive(),
               "Standard deviation of the motion if it was carried, per axis.")
          .add("jump_deviation_rad", &P::jump_deviation_rad, "rad", positive(),
               "Standard deviation of the turn if it was carried.")
          .add("start_deviation_m", &P::start_deviation_m, "m", positive(),
               "Standard deviation of the place where a lost robot was found, per axis.")
          .add("start_deviation_rad", &P::start_deviation_rad, "rad", positive(),
               "The same of its heading.")
          .add("start_path_m", &P::start_path_m, "m", atLeast(0.0),
               "Path along which odometry drifts as much.")
          .add("view_range_m", &P::view_range_m, "m", positive(),
               "Points farther away do not count for the centre of what a scan sees.")
          .add("path_m_per_rad", &P::path_m_per_rad, "m/rad", atLeast(0.0),
               "Path that turning counts as, because odometry drifts by it, too.")
          .add("farthest_reference", &P::farthest_reference, "", atLeast(1),
               "A new key scan is aligned with those 1, 2, 4, .. back, up to this.")
          .add("alignment_motion_weight", &P::motion_weight, "", positive(),
               "Weight of this alignment against that with key scans of earlier passages.")
          .add("between_distance_m", &P::between_distance_m, "m", positive(),
               "Between two key scans a scan is aligned, too, after so much motion.")
          .add("between_angle_rad", &P::between_angle_rad, "rad", positive(),
               "Between two key scans a scan is aligned, too, after so much turning.")
          .add("between_reference_count", &P::between_reference_count, "", atLeast(1),
               "Newest key scans that the scans between two of them are aligned with.")
          .add("rest_s", &P::rest_s, "s", positive(),
               "Of a rest that was longer, or a pause of the scans, the end is kept, too.")
          .add("pose_per_scan", &P::pose_per_scan,
               "The trajectory has a pose for each scan, not for the aligned ones only: for logs.");
  return table;
}

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
