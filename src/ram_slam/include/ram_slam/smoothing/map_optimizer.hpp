// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/joint_refinement.hpp"
#include "ram_slam/smoothing/key_scans.hpp"
#include "ram_slam/smoothing/loop_closer.hpp"

namespace ram_slam {

/// Moves the key scans to where motion, closures and their readings agree best.
class MapOptimizer {
public:
  MapOptimizer(const PoseGraphParameters& graph,
               const RefinementParameters& refinement,
               const ScanMatcherParameters& matcher);

  /// Solves the graph of aligned motion and closures; closures that the rest contradicts are
  /// outvoted, and accepted again once others support them.
  void solve(KeyScans& key_scans, LoopCloser& loops);

  /// Aligns the readings of all key scans with each other, held by the given motion.
  void refine(KeyScans& key_scans) const;

private:
  PoseGraphParameters graph_;
  RefinementParameters refinement_;
  ScanMatcherParameters matcher_;
  double judged_chi2_ = 0.0;  ///< cost of the graph when its closures were judged last
};

/// Poses of the laser at the key scans, with the edges of aligned motion and accepted closures, in
/// this order.
PoseGraph laserGraph(const KeyScans& key_scans, const LoopCloser& loops);

/// The same graph with the closures that were outvoted, marked.
/// \param judged_chi2  as in PoseGraph
PoseGraph candidateGraph(const KeyScans& key_scans, const LoopCloser& loops, double judged_chi2);

/// laserGraph() with poses of the base.
PoseGraph baseGraph(const KeyScans& key_scans, const LoopCloser& loops);

}  // namespace ram_slam
