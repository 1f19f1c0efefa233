// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/joint_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "ram_parameters/require.hpp"

namespace ram_slam {
namespace {

constexpr std::size_t kMinLoopGap = 10;    // key scans between a scan and one of another passage
constexpr std::size_t kMinPassageGap = 5;  // and between two of those
constexpr double kDampingInformation =
    100;  // keeps what a pair leaves open where it is: 0.1 m, 0.1 rad
constexpr int kSolverIterations = 3;

using ram_parameters::require;

struct ScanPair {
  std::size_t target;
  std::size_t source;
};

std::vector<ScanPair> chainPairs(std::size_t count) {
  std::vector<ScanPair> pairs;
  for (std::size_t source = 1; source < count; ++source) {
    for (std::size_t back = 1; back <= std::min<std::size_t>(source, 8); back *= 2)
      pairs.push_back({source - back, source});
  }
  return pairs;
}

/// The scans of other passages that look at the same place the most closely.
std::vector<ScanPair> loopPairs(const std::vector<KeyScan>& key_scans,
                                const RefinementParameters& parameters) {
  std::vector<Eigen::Vector2d> centres;
  for (const KeyScan& key : key_scans)
    centres.push_back(key.map_from_laser * key.view_centre_in_laser_m);
  std::vector<ScanPair> pairs;
  for (std::size_t source = kMinLoopGap; source < key_scans.size(); ++source) {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t target = 0; target + kMinLoopGap <= source; ++target) {
      const double squared = (centres[target] - centres[source]).squaredNorm();
      if (squared > parameters.max_view_distance_m * parameters.max_view_distance_m) continue;
      const double turn = wrapAngle(key_scans[target].map_from_laser.yaw_rad -
                                    key_scans[source].map_from_laser.yaw_rad);
      if (std::abs(turn) <= parameters.max_angle_rad) near.emplace_back(squared, target);
    }
    std::sort(near.begin(), near.end());
    std::vector<std::size_t> chosen;
    for (const auto& [squared, target] : near) {
      if (chosen.size() == static_cast<std::size_t>(parameters.loop_neighbour_count)) break;
      const bool is_other =
          std::all_of(chosen.begin(), chosen.end(), [&, here = target](std::size_t other) {
            return (here > other ? here - other : other - here) >= kMinPassageGap;
          });
      if (is_other) chosen.push_back(target);
    }
    for (const std::size_t target : chosen) pairs.push_back({target, source});
  }
  return pairs;
}

/// The relative pose that a pair of scans wants, near the one it has.
PoseEdge linearise(const ScanPair& pair,
                   const std::vector<KeyScan>& key_scans,
                   const std::vector<Pose2>& map_from_laser,
                   const PairingLimits& limits,
                   double information_per_pair,
                   double min_inlier_ratio) {
  PoseEdge edge;
  edge.from = pair.target;
  edge.to = pair.source;
  edge.from_from_to = map_from_laser[pair.target].inverse() * map_from_laser[pair.source];
  const PointToLineSum sum = sumPointToLine(
      key_scans[pair.target].surfaces, key_scans[pair.source].surfaces, edge.from_from_to, limits);
  edge.information = Eigen::Matrix3d::Zero();
  if (static_cast<double>(sum.pair_count) <
      min_inlier_ratio * static_cast<double>(sum.visible_count))
    return edge;
  if (sum.pair_count == 0) return edge;
  edge.information =
      information_per_pair * sum.information + kDampingInformation * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d step = -edge.information.ldlt().solve(information_per_pair * sum.gradient);
  edge.from_from_to.x_m += step.x();
  edge.from_from_to.y_m += step.y();
  edge.from_from_to.yaw_rad = wrapAngle(edge.from_from_to.yaw_rad + step.z());
  return edge;
}

}  // namespace

void RefinementParameters::validate() const {
  require(iterations >= 0, "iterations", iterations, ">= 0");
  require(loop_neighbour_count >= 0, "loop_neighbour_count", loop_neighbour_count, ">= 0");
  require(max_view_distance_m > 0.0, "max_view_distance_m", max_view_distance_m, "> 0");
  require(max_angle_rad > 0.0, "max_angle_rad", max_angle_rad, "> 0");
  require(min_inlier_ratio >= 0.0 && min_inlier_ratio <= 1.0, "min_inlier_ratio", min_inlier_ratio,
          "in [0, 1]");
}

std::vector<Pose2> refineJointly(const std::vector<KeyScan>& key_scans,
                                 const std::vector<PoseEdge>& motion,
                                 const ScanMatcherParameters& matcher,
                                 const RefinementParameters& parameters) {
  std::vector<ScanPair> pairs = chainPairs(key_scans.size());
  const std::vector<ScanPair> loops = loopPairs(key_scans, parameters);
  pairs.insert(pairs.end(), loops.begin(), loops.end());

  PairingLimits limits;
  limits.max_distance_m = matcher.first_gate_m;
  limits.min_normal_cosine = matcher.min_normal_cosine;
  limits.robust_scale_m = matcher.robust_scale_m;
  const double information_per_pair =
      1.0 / (matcher.range_deviation_m * matcher.range_deviation_m * matcher.correlated_beams);
  PoseGraphParameters solver;
  solver.max_iterations = kSolverIterations;

  PoseGraph graph;
  for (const KeyScan& key : key_scans) graph.map_from_node.push_back(key.map_from_laser);
  for (int iteration = 0; iteration < parameters.iterations; ++iteration) {
    graph.edges = motion;
    for (const ScanPair& pair : pairs) {
      const PoseEdge edge = linearise(pair, key_scans, graph.map_from_node, limits,
                                      information_per_pair, parameters.min_inlier_ratio);
      if (edge.information(2, 2) > 0.0) graph.edges.push_back(edge);
    }
    graph.map_from_node = solvePoseGraph(graph, solver).map_from_node;
    limits.max_distance_m = std::max(matcher.last_gate_m, 0.6 * limits.max_distance_m);
  }
  return graph.map_from_node;
}

}  // namespace ram_slam
