// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/key_scan.hpp"
#include "ram_slam/smoothing/pose_graph.hpp"

namespace ram_slam {

/// Settings of the joint refinement.
struct RefinementParameters {
  int iterations = 5;  ///< of pairing points anew; 0 leaves the poses as they are
  int loop_neighbour_count =
      4;  ///< key scans of other passages that each one is paired with, at most
  double max_view_distance_m = 2.5;  ///< between what two scans look at
  double max_angle_rad = 3.2;        ///< between their headings
  double min_inlier_ratio =
      0.4;  ///< share of points that find a partner; pairs of scans below say nothing

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Moves all key scans together so that their points lie on each other's lines: least squares over
/// the point-to-line distances of all pairs of scans that see the same place, and over `motion`
/// (edges between laser poses), which holds what no wall does.
///
/// Each pair's distances are summed into one quadratic form of the relative pose, so that the size
/// of the problem does not depend on the number of points; points are paired anew in each
/// iteration.
std::vector<Pose2> refineJointly(const std::vector<KeyScan>& key_scans,
                                 const std::vector<PoseEdge>& motion,
                                 const ScanMatcherParameters& matcher,
                                 const RefinementParameters& parameters);

}  // namespace ram_slam
