// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_optimizer.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ram_slam {

MapOptimizer::MapOptimizer(const PoseGraphParameters& graph,
                           const RefinementParameters& refinement,
                           const ScanMatcherParameters& matcher)
    : graph_(graph), refinement_(refinement), matcher_(matcher) {}

void MapOptimizer::solve(KeyScans& key_scans, LoopCloser& loops) {
  const PoseGraph graph = candidateGraph(key_scans, loops, judged_chi2_);
  const PoseGraphSolution solution = solvePoseGraph(graph, graph_);
  key_scans.setPoses(solution.map_from_node);
  // It falls when closures are taken back.
  judged_chi2_ = solution.is_judged ? solution.chi2 : std::min(judged_chi2_, solution.chi2);
  const auto motion_count = static_cast<std::ptrdiff_t>(key_scans.alignedMotion().size());
  loops.judge({solution.edge_trust.begin() + motion_count, solution.edge_trust.end()},
              graph_.min_trust);
}

void MapOptimizer::refine(KeyScans& key_scans) const {
  key_scans.setPoses(
      refineJointly(key_scans.keys(), key_scans.givenMotion(), matcher_, refinement_));
}

namespace {

PoseGraph motionGraph(const KeyScans& key_scans) {
  PoseGraph graph;
  for (const KeyScan& key : key_scans.keys()) graph.map_from_node.push_back(key.map_from_laser);
  graph.edges = key_scans.alignedMotion();
  // Nothing measures these: they are to keep what the closures found.
  for (PoseEdge& edge : graph.edges) {
    if (key_scans.keys()[edge.to].is_jump)
      edge.from_from_to = relativePose(key_scans.keys()[edge.from], key_scans.keys()[edge.to]);
  }
  return graph;
}

}  // namespace

PoseGraph candidateGraph(const KeyScans& key_scans, const LoopCloser& loops, double judged_chi2) {
  PoseGraph graph = motionGraph(key_scans);
  const std::vector<PoseEdge> closures = loops.candidateEdges();
  graph.edges.insert(graph.edges.end(), closures.begin(), closures.end());
  graph.judged_chi2 = judged_chi2;
  return graph;
}

PoseGraph laserGraph(const KeyScans& key_scans, const LoopCloser& loops) {
  PoseGraph graph = motionGraph(key_scans);
  const std::vector<PoseEdge> closures = loops.acceptedEdges();
  graph.edges.insert(graph.edges.end(), closures.begin(), closures.end());
  return graph;
}

PoseGraph baseGraph(const KeyScans& key_scans, const LoopCloser& loops) {
  const std::vector<KeyScan>& keys = key_scans.keys();
  PoseGraph graph = laserGraph(key_scans, loops);
  for (std::size_t i = 0; i < keys.size(); ++i) graph.map_from_node[i] = keys[i].map_from_base();
  for (PoseEdge& edge : graph.edges) {
    edge.from_from_to = keys[edge.from].base_from_laser * edge.from_from_to *
                        keys[edge.to].base_from_laser.inverse();
    const Eigen::Matrix3d turn = keys[edge.from].base_from_laser.axesRotation();
    edge.information = turn * edge.information * turn.transpose();
  }
  return graph;
}

}  // namespace ram_slam
