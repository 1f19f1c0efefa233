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

  /// Solves the graph of aligned motion and accepted closures; closures that the rest contradicts
  /// are outvoted.
  void solve(KeyScans& key_scans, LoopCloser& loops) const;

  /// Aligns the readings of all key scans with each other, held by the given motion.
  void refine(KeyScans& key_scans) const;

private:
  PoseGraphParameters graph_;
  RefinementParameters refinement_;
  ScanMatcherParameters matcher_;
};

/// Poses of the laser at the key scans, with the edges of aligned motion and accepted closures, in
/// this order.
PoseGraph laserGraph(const KeyScans& key_scans, const LoopCloser& loops);

/// The same graph with poses of the base.
PoseGraph baseGraph(const KeyScans& key_scans, const LoopCloser& loops);

}  // namespace ram_slam
