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

/// Key scans of other passages about the same place, the nearest views first.
std::vector<std::size_t> nearViews(const std::vector<KeyScan>& key_scans,
                                   const std::vector<Eigen::Vector2d>& centres,
                                   std::size_t source,
                                   const RefinementParameters& parameters) {
  const auto gap = static_cast<std::size_t>(parameters.min_loop_gap);
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t target = 0; target + gap <= source; ++target) {
    const double squared = (centres[target] - centres[source]).squaredNorm();
    if (squared > parameters.max_view_distance_m * parameters.max_view_distance_m) continue;
    const double turn = wrapAngle(key_scans[target].map_from_laser.yaw_rad -
                                  key_scans[source].map_from_laser.yaw_rad);
    if (std::abs(turn) <= parameters.max_angle_rad) near.emplace_back(squared, target);
  }
  std::sort(near.begin(), near.end());
  std::vector<std::size_t> keys;
  for (const auto& [squared, target] : near) keys.push_back(target);
  return keys;
}

/// One of each passage, the first ones.
std::vector<std::size_t> oneOfEachPassage(const std::vector<std::size_t>& keys,
                                          const RefinementParameters& parameters) {
  const auto gap = static_cast<std::size_t>(parameters.min_passage_gap);
  std::vector<std::size_t> chosen;
  for (const std::size_t key : keys) {
    if (chosen.size() == static_cast<std::size_t>(parameters.loop_neighbour_count)) break;
    const bool is_other = std::all_of(chosen.begin(), chosen.end(), [&](std::size_t other) {
      return (key > other ? key - other : other - key) >= gap;
    });
    if (is_other) chosen.push_back(key);
  }
  return chosen;
}

/// Each key scan with those of other passages whose view centres are nearest.
std::vector<ScanPair> loopPairs(const std::vector<KeyScan>& key_scans,
                                const RefinementParameters& parameters) {
  std::vector<Eigen::Vector2d> centres;
  for (const KeyScan& key : key_scans) centres.push_back(key.viewCentreInMap());
  std::vector<ScanPair> pairs;
  for (auto source = static_cast<std::size_t>(parameters.min_loop_gap); source < key_scans.size();
       ++source) {
    if (key_scans[source].is_loaded) continue;
    const std::vector<std::size_t> near = nearViews(key_scans, centres, source, parameters);
    for (const std::size_t target : oneOfEachPassage(near, parameters))
      pairs.push_back({target, source});
  }
  return pairs;
}

/// The pairing of points and what a pair of points weighs.
struct Pairing {
  PairingLimits limits;
  double information_per_pair = 0.0;  ///< [1/m^2]
};

Pairing firstPairing(const ScanMatcherParameters& matcher) {
  Pairing pairing;
  pairing.limits.max_distance_m = matcher.first_gate_m;
  pairing.limits.min_normal_cosine = matcher.min_normal_cosine;
  pairing.limits.robust_scale_m = matcher.robust_scale_m;
  pairing.information_per_pair =
      1.0 / (matcher.range_deviation_m * matcher.range_deviation_m * matcher.correlated_beams);
  return pairing;
}

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
  const double least = parameters.min_inlier_ratio * static_cast<double>(sum.visible_count);
  if (static_cast<double>(sum.pair_count) < least || sum.pair_count == 0) return edge;
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
          .add("loop_neighbour_count", &P::loop_neighbour_count, "", atLeast(0),
               "Most key scans of other passages that each one is paired with.")
          .add("max_view_distance_m", &P::max_view_distance_m, "m", positive(),
               "Greatest distance between the centres of what two scans see.")
          .add("max_angle_rad", &P::max_angle_rad, "rad", positive(),
               "Greatest angle between the headings of two scans.")
          .add("min_inlier_ratio", &P::min_inlier_ratio, "", within(0.0, 1.0),
               "Pairs of scans with a smaller share of paired points do not count.")
          .expert("Pairs of the alignment of all key scans")
          .add("farthest_neighbour", &P::farthest_neighbour, "", atLeast(1),
               "Each key scan is paired with those 1, 2, 4, .. back, up to this.")
          .add("min_loop_gap", &P::min_loop_gap, "", atLeast(1),
               "Least number of key scans between one and another passage.")
          .add("min_passage_gap", &P::min_passage_gap, "", atLeast(1),
               "Least number of key scans between two other passages.")
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

  Pairing pairing = firstPairing(matcher);
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
