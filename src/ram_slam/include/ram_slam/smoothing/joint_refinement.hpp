// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/near_views.hpp"

namespace ram_slam {

/// Settings of the joint refinement. Keys are those of config/map_smoother.yaml without
/// "refinement_".
struct RefinementParameters {
  int iterations = 5;             ///< of pairing points and solving; 0 leaves the poses as they are
  double min_inlier_ratio = 0.4;  ///< share of points with a partner; pairs below do not count
  NearViewParameters near_views;

  int farthest_neighbour = 16;  ///< each key scan is paired with those 1, 2, 4, .. this back
  double damping_information =
      100.0;                  ///< keeps what a pair leaves open where it is: 0.1 m, 0.1 rad
  int solver_iterations = 3;  ///< of the pose graph, per iteration

  static const ram_parameters::ParameterTable<RefinementParameters>& table();
};

/// Moves all key scans together so that their points lie on each other's lines: least squares over
/// the point-to-line distances of all pairs of scans that see the same place, and over `motion`
/// (edges between laser poses), which holds what no wall does.
///
/// Each pair's distances are summed into one quadratic form of the relative pose, so that the size
/// of the problem does not depend on the number of points; points are paired again in each
/// iteration (Lu and Milios, Autonomous Robots 1997).
std::vector<Pose2> refineJointly(const std::vector<KeyScan>& key_scans,
                                 const std::vector<PoseEdge>& motion,
                                 const ScanMatcherParameters& matcher,
                                 const RefinementParameters& parameters);

}  // namespace ram_slam
