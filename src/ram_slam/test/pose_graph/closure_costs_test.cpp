// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/pose_graph/closure_costs.hpp"

#include <gmock/gmock.h>

#include "false_closure.hpp"

namespace ram_slam {
namespace {

/// Nodes on a line, each 1 m, with edges of deviation 1 in every axis.
PoseGraph line(std::size_t edge_count) {
  PoseGraph graph;
  for (std::size_t i = 0; i <= edge_count; ++i)
    graph.map_from_node.push_back({static_cast<double>(i), 0.0, 0.0});
  for (std::size_t i = 0; i < edge_count; ++i)
    graph.edges.push_back({i, i + 1, {1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity(), false, false});
  return graph;
}

PoseEdge closure(std::size_t from, std::size_t to, double length_m) {
  return {from, to, {length_m, 0.0, 0.0}, Eigen::Matrix3d::Identity(), true, false};
}

double costOfLast(const PoseGraph& graph, const std::vector<Pose2>& poses, double beside_m) {
  const std::vector<bool> none(graph.edges.size(), false);
  return closureCosts(graph, poses, none, beside_m).back();
}

TEST(ClosureCosts, OneClosureCostsItsMisfitOverTheVarianceOfTheChainAndItself) {
  // 9 edges of variance 1 and the closure's own: r^2 / 10.
  PoseGraph graph = line(9);
  graph.edges.push_back(closure(0, 9, 9.0 + 5.0));
  const PoseGraphSolution solution = solvePoseGraph(graph, {});
  EXPECT_NEAR(costOfLast(graph, solution.map_from_node, 0.0), 25.0 / 10.0, 1e-3);
  EXPECT_NEAR(solution.chi2, 25.0 / 10.0, 1e-3);
}

TEST(ClosureCosts, AClosureThatIsLeftOutCostsTheSame) {
  PoseGraph graph = line(9);
  graph.edges.push_back(closure(0, 9, 9.0 + 5.0));
  std::vector<bool> is_left_out(graph.edges.size(), false);
  is_left_out.back() = true;
  const std::vector<double> costs = closureCosts(graph, graph.map_from_node, is_left_out, 0.0);
  EXPECT_NEAR(costs.back(), 25.0 / 10.0, 1e-6);
}

TEST(ClosureCosts, ClosuresBesideEachOtherDoNotSupportEachOther) {
  PoseGraph graph = line(9);
  graph.edges.push_back(closure(0, 9, 9.0 + 5.0));
  graph.edges.push_back(closure(0, 9, 9.0 + 5.0));
  const std::vector<Pose2> poses = solvePoseGraph(graph, {}).map_from_node;
  EXPECT_NEAR(costOfLast(graph, poses, 1.0), 25.0 / 10.0, 1e-3);
}

TEST(ClosureCosts, AClosureThatAnotherPlaceSupportsCostsLittle) {
  PoseGraph graph = line(9);
  graph.edges.push_back(closure(0, 8, 8.0 + 5.0));
  graph.edges.push_back(closure(2, 9, 7.0 + 5.0));
  const std::vector<Pose2> poses = solvePoseGraph(graph, {}).map_from_node;
  EXPECT_GT(costOfLast(graph, poses, 5.0), 2.0);
  EXPECT_LT(costOfLast(graph, poses, 1.0), 1.0);
}

TEST(ClosureCosts, DirectionsThatAClosureDoesNotHoldCostNothing) {
  PoseGraph graph = line(9);
  PoseEdge open = closure(0, 9, 9.0 + 5.0);
  open.information(0, 0) = 0.0;
  open.from_from_to.y_m = 0.3;
  open.information(2, 2) = 0.0;
  graph.edges.push_back(open);
  const std::vector<Pose2> poses = solvePoseGraph(graph, {}).map_from_node;
  // Across the line the yaws of the edges add sum k^2, k = 0 .. 8, to 9 edges and the closure.
  EXPECT_NEAR(costOfLast(graph, poses, 0.0), 0.09 / (10.0 + 204.0), 2e-5);
}

TEST(ClosureCosts, EdgesThatCannotBeFalseHaveNoCost) {
  PoseGraph graph = line(3);
  graph.edges.push_back(closure(0, 3, 4.0));
  const std::vector<bool> none(graph.edges.size(), false);
  const std::vector<double> costs = closureCosts(graph, graph.map_from_node, none, 0.0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(costs[i], 0.0);
}

TEST(SolvePoseGraph, RefusesAClosureThatBendsAWeakChainAndLeavesTheChainAsItIs) {
  for (const double angle_rad : {0.5, 1.0, M_PI_2, 2.4, 3.1}) {
    const PoseGraph graph = chainWithFalseClosure(600, 0.2, angle_rad);
    const PoseGraphSolution solution = solvePoseGraph(graph, {});
    EXPECT_LT(solution.edge_trust.back(), 0.5) << angle_rad;
    for (std::size_t i = 0; i < graph.map_from_node.size(); ++i) {
      const Pose2 shift = graph.map_from_node[i].inverse() * solution.map_from_node[i];
      EXPECT_LT(shift.translation().norm(), 1e-6) << angle_rad;
    }
    EXPECT_NEAR(solution.chi2, 0.0, 1e-6);
  }
}

TEST(SolvePoseGraph, AcceptsATrueClosureBesideFalseOnes) {
  PoseGraph graph = chainWithFalseClosure(600, 0.2, M_PI_2);
  PoseEdge right = graph.edges.back();
  right.from += 60;
  right.to -= 60;
  right.from_from_to =
      graph.map_from_node[right.from].inverse() * graph.map_from_node[right.to] * Pose2{0.1, 0, 0};
  graph.edges.push_back(right);
  const PoseGraphSolution solution = solvePoseGraph(graph, {});
  EXPECT_EQ(solution.edge_trust.back(), 1.0);
  EXPECT_LT(solution.edge_trust[graph.edges.size() - 2], 0.5);
}

TEST(SolvePoseGraph, AcceptsADearClosureOnceAnotherPlaceSupportsIt) {
  // The robot turned by more than four deviations of the chain without noticing.
  PoseGraph graph = chainWithFalseClosure(300, 0.05, 0.0);
  PoseEdge& first = graph.edges.back();
  first.from += 45;
  first.to -= 45;
  const Pose2 slip{0.0, 0.0, 0.1};
  std::vector<Pose2> truth = graph.map_from_node;
  for (std::size_t i = 150; i < truth.size(); ++i)
    truth[i] = truth[149] * slip * (graph.map_from_node[149].inverse() * truth[i]);
  first.from_from_to = truth[first.from].inverse() * truth[first.to];
  PoseGraphParameters parameters;
  parameters.closure_beside_m = 4.0;
  EXPECT_LT(solvePoseGraph(graph, parameters).edge_trust.back(), 0.5);  // alone it is refused
  PoseEdge second = first;
  second.from -= 15;
  second.to += 15;
  second.from_from_to = truth[second.from].inverse() * truth[second.to];
  graph.edges.push_back(second);
  const PoseGraphSolution solution = solvePoseGraph(graph, parameters);
  EXPECT_EQ(solution.edge_trust[graph.edges.size() - 2], 1.0);
  EXPECT_EQ(solution.edge_trust.back(), 1.0);
}

}  // namespace
}  // namespace ram_slam
