// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/joint_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace ram_slam {
namespace {

struct ScanPair {
  std::size_t target;
  std::size_t source;
};

std::vector<ScanPair> chainPairs(const std::vector<KeyScan>& key_scans, std::size_t farthest) {
  std::vector<ScanPair> pairs;
  std::size_t session_begin = 0;
  for (std::size_t source = 1; source < key_scans.size(); ++source) {
    if (key_scans[source].is_loaded) continue;  // it stays where it is
    if (key_scans[source].is_start) session_begin = source;
    for (std::size_t back = 1; back <= std::min(source - session_begin, farthest); back *= 2)
      pairs.push_back({source - back, source});
  }
  return pairs;
}

/// Each key scan with those of other passages whose view centres are nearest.
std::vector<ScanPair> loopPairs(const std::vector<KeyScan>& key_scans,
                                const RefinementParameters& parameters) {
  std::vector<ScanPair> pairs;
  for (std::size_t source = 0; source < key_scans.size(); ++source) {
    if (key_scans[source].is_loaded) continue;
    for (const std::size_t target : nearViews(key_scans, source, parameters.near_views))
      pairs.push_back({target, source});
  }
  return pairs;
}

/// How points are paired and what a pair of them weighs.
struct Pairing {
  PairingLimits limits;
  double information_per_pair = 0.0;  ///< [1/m^2]
};

/// The relative pose that a pair of scans wants, near the one it has; without information if too
/// few of their points are paired.
PoseEdge linearise(const ScanPair& pair,
                   const std::vector<KeyScan>& key_scans,
                   const std::vector<Pose2>& map_from_laser,
                   const Pairing& pairing,
                   const RefinementParameters& parameters) {
  PoseEdge edge;
  edge.from = pair.target;
  edge.to = pair.source;
  edge.from_from_to = map_from_laser[pair.target].inverse() * map_from_laser[pair.source];
  const PointToLineSum sum =
      sumPointToLine(key_scans[pair.target].surfaces, key_scans[pair.source].surfaces,
                     edge.from_from_to, pairing.limits);
  edge.information = Eigen::Matrix3d::Zero();
  if (sum.pair_count == 0 || sum.inlierRatio() < parameters.min_inlier_ratio) return edge;
  edge.information = pairing.information_per_pair * sum.information +
                     parameters.damping_information * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d step =
      -edge.information.ldlt().solve(pairing.information_per_pair * sum.gradient);
  edge.from_from_to.x_m += step.x();
  edge.from_from_to.y_m += step.y();
  edge.from_from_to.yaw_rad = wrapAngle(edge.from_from_to.yaw_rad + step.z());
  return edge;
}

}  // namespace

const ram_parameters::ParameterTable<RefinementParameters>& RefinementParameters::table() {
  using namespace ram_parameters;
  using P = RefinementParameters;
  static const auto table =
      ParameterTable<P>()
          .add("iterations", &P::iterations, "", atLeast(0),
               "Times that points are paired and the poses solved for; 0 leaves it out.")
          .add("min_inlier_ratio", &P::min_inlier_ratio, "", within(0.0, 1.0),
               "Pairs of scans with a smaller share of paired points do not count.")
          .include(&P::near_views, NearViewParameters::table())
          .expert("Pairs of the alignment of all key scans")
          .add("farthest_neighbour", &P::farthest_neighbour, "", atLeast(1),
               "Each key scan is paired with those 1, 2, 4, .. back, up to this.")
          .add("damping_information", &P::damping_information, "1/m^2, 1/rad^2", positive(),
               "Information that holds what a pair of scans leaves open.")
          .add("solver_iterations", &P::solver_iterations, "", atLeast(1),
               "Iterations of the pose graph's solver in each of these.");
  return table;
}

std::vector<Pose2> refineJointly(const std::vector<KeyScan>& key_scans,
                                 const std::vector<PoseEdge>& motion,
                                 const ScanMatcherParameters& matcher,
                                 const RefinementParameters& parameters) {
  std::vector<ScanPair> pairs =
      chainPairs(key_scans, static_cast<std::size_t>(parameters.farthest_neighbour));
  const std::vector<ScanPair> loops = loopPairs(key_scans, parameters);
  pairs.insert(pairs.end(), loops.begin(), loops.end());

  const double variance_m2 = matcher.range_deviation_m * matcher.range_deviation_m;
  Pairing pairing{matcher.firstPairing(), 1.0 / (variance_m2 * matcher.correlated_beams)};
  PoseGraphParameters solver;
  solver.max_iterations = parameters.solver_iterations;
  PoseGraph graph;
  for (const KeyScan& key : key_scans) graph.map_from_node.push_back(key.map_from_laser);
  for (int iteration = 0; iteration < parameters.iterations; ++iteration) {
    graph.edges = motion;
    for (const ScanPair& pair : pairs) {
      const PoseEdge edge = linearise(pair, key_scans, graph.map_from_node, pairing, parameters);
      if (edge.information(2, 2) > 0.0) graph.edges.push_back(edge);
    }
    graph.map_from_node = solvePoseGraph(graph, solver).map_from_node;
    double& gate_m = pairing.limits.max_distance_m;
    gate_m = std::max(matcher.last_gate_m, matcher.gate_shrink * gate_m);
  }
  return graph.map_from_node;
}

}  // namespace ram_slam
