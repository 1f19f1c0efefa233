// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/require.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"

namespace ram_slam {

using ram_parameters::requirePositive;

void MapSmootherParameters::validate() const {
  surfaces.validate();
  matcher.validate();
  loops.validate();
  graph.validate();
  refinement.validate();
  ram_parameters::require(optimize_period_s >= 0.0, "optimize_period_s", optimize_period_s, ">= 0");
  requirePositive("key_scan_distance_m", key_scan_distance_m);
  requirePositive("key_scan_angle_rad", key_scan_angle_rad);
  requirePositive("loop_search_distance_m", loop_search_distance_m);
  ram_parameters::require(loop_constellation_path_m >= 0.0, "loop_constellation_path_m",
                          loop_constellation_path_m, ">= 0");
  requirePositive("motion_rest_deviation_m", motion_rest_deviation_m);
  requirePositive("motion_rest_deviation_rad", motion_rest_deviation_rad);
  requirePositive("motion_deviation_m_per_m", motion_deviation_m_per_m);
  requirePositive("motion_deviation_rad_per_m", motion_deviation_rad_per_m);
  requirePositive("motion_deviation_rad_per_rad", motion_deviation_rad_per_rad);
  requirePositive("match_deviation_m", match_deviation_m);
  requirePositive("match_deviation_rad", match_deviation_rad);
  requirePositive("closure_deviation_m", closure_deviation_m);
  requirePositive("closure_deviation_rad", closure_deviation_rad);
}

MapSmootherParameters readMapSmootherParameters(ram_parameters::ParameterReader& reader) {
  MapSmootherParameters parameters;
  reader.read("map_frame", parameters.map_frame);
  reader.read("base_frame", parameters.base_frame);
  reader.read("optimize_period_s", parameters.optimize_period_s);
  SurfaceParameters::table().read(reader, parameters.surfaces);
  ScanMatcherParameters::table().read(reader, parameters.matcher);
  reader.read("key_scan_distance_m", parameters.key_scan_distance_m);
  reader.read("key_scan_angle_rad", parameters.key_scan_angle_rad);
  reader.read("motion_rest_deviation_m", parameters.motion_rest_deviation_m);
  reader.read("motion_rest_deviation_rad", parameters.motion_rest_deviation_rad);
  reader.read("motion_deviation_m_per_m", parameters.motion_deviation_m_per_m);
  reader.read("motion_deviation_rad_per_m", parameters.motion_deviation_rad_per_m);
  reader.read("motion_deviation_rad_per_rad", parameters.motion_deviation_rad_per_rad);
  reader.read("match_deviation_m", parameters.match_deviation_m);
  reader.read("match_deviation_rad", parameters.match_deviation_rad);
  reader.read("closure_deviation_m", parameters.closure_deviation_m);
  reader.read("closure_deviation_rad", parameters.closure_deviation_rad);
  reader.read("loop_search_distance_m", parameters.loop_search_distance_m);
  reader.read("loop_constellation_path_m", parameters.loop_constellation_path_m);
  reader.read("loop_min_path_m", parameters.loops.min_path_m);
  reader.read("loop_max_view_distance_m", parameters.loops.max_view_distance_m);
  reader.read("loop_drift_m_per_m", parameters.loops.drift_m_per_m);
  reader.read("loop_drift_rad_per_m", parameters.loops.drift_rad_per_m);
  reader.read("loop_max_distance_m", parameters.loops.max_distance_m);
  reader.read("loop_max_angle_rad", parameters.loops.max_angle_rad);
  reader.read("loop_neighbour_count", parameters.loops.neighbour_count);
  reader.read("loop_min_score", parameters.loops.min_score);
  reader.read("loop_min_inlier_ratio", parameters.loops.min_inlier_ratio);
  reader.read("loop_max_free_space_ratio", parameters.loops.max_free_space_ratio);
  reader.read("loop_max_round_trip_m", parameters.loops.max_round_trip_m);
  reader.read("loop_max_round_trip_rad", parameters.loops.max_round_trip_rad);
  reader.read("closure_tolerance_chi2", parameters.graph.closure_tolerance_chi2);
  reader.read("graph_max_iterations", parameters.graph.max_iterations);
  reader.read("refinement_iterations", parameters.refinement.iterations);
  reader.read("refinement_loop_neighbour_count", parameters.refinement.loop_neighbour_count);
  reader.read("refinement_max_view_distance_m", parameters.refinement.max_view_distance_m);
  reader.read("refinement_max_angle_rad", parameters.refinement.max_angle_rad);
  reader.read("refinement_min_inlier_ratio", parameters.refinement.min_inlier_ratio);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

}  // namespace ram_slam
