// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/pose_graph/pose_graph.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double distance(const Pose2& a, const Pose2& b) {
  return (a.translation() - b.translation()).norm();
}

PoseEdge between(const std::vector<Pose2>& poses, std::size_t from, std::size_t to) {
  PoseEdge edge;
  edge.from = from;
  edge.to = to;
  edge.from_from_to = poses[from].inverse() * poses[to];
  return edge;
}

/// Laps about a square of 10 m with a pose each half metre.
std::vector<Pose2> laps(int count) {
  std::vector<Pose2> poses{Pose2{}};
  for (int step = 0; step < 80 * count; ++step) {
    const double turn = step % 20 == 19 ? M_PI_2 : 0.0;
    poses.push_back(poses.back() * Pose2{0.5, 0.0, turn});
  }
  return poses;
}

/// The drive as noisy odometry measures it, with true closures between the laps.
PoseGraph noisyGraph(const std::vector<Pose2>& truth) {
  PoseGraph graph;
  Random random(3);
  Eigen::Matrix3d covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  graph.map_from_node.push_back(truth[0]);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    PoseEdge edge = between(truth, i - 1, i);
    edge.from_from_to = edge.from_from_to * exponential(random.gaussian(covariance));
    edge.information = covariance.inverse();
    graph.map_from_node.push_back(graph.map_from_node.back() * edge.from_from_to);
    graph.edges.push_back(edge);
  }
  for (std::size_t i = 80; i < truth.size(); i += 4) {
    PoseEdge closure = between(truth, i - 80, i);
    closure.from_from_to = closure.from_from_to * exponential(random.gaussian(covariance));
    closure.information = covariance.inverse();
    closure.may_be_false = true;
    graph.edges.push_back(closure);
  }
  return graph;
}

double meanError(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) sum += distance(poses[i], truth[i]);
  return sum / static_cast<double>(poses.size());
}

TEST(SolvePoseGraph, SpreadsAMisfitEvenlyOverAChainAndItsClosure) {
  // n edges of 1 m and a closure that measures n + r: each edge takes r / (n + 1).
  constexpr std::size_t kEdges = 9;
  constexpr double kMisfitM = 0.5;
  PoseGraph graph;
  for (std::size_t i = 0; i <= kEdges; ++i)
    graph.map_from_node.push_back({static_cast<double>(i), 0.0, 0.0});
  for (std::size_t i = 0; i < kEdges; ++i)
    graph.edges.push_back(between(graph.map_from_node, i, i + 1));
  PoseEdge closure = between(graph.map_from_node, 0, kEdges);
  closure.from_from_to.x_m += kMisfitM;
  graph.edges.push_back(closure);

  const PoseGraphSolution solution = solvePoseGraph(graph, {});
  for (std::size_t i = 0; i <= kEdges; ++i) {
    const double expected = static_cast<double>(i) * (1.0 + kMisfitM / (kEdges + 1));
    EXPECT_NEAR(solution.map_from_node[i].x_m, expected, 1e-6);
    EXPECT_NEAR(solution.map_from_node[i].y_m, 0.0, 1e-9);
  }
}

TEST(SolvePoseGraph, LeavesAConsistentGraphAsItIs) {
  PoseGraph graph;
  graph.map_from_node = laps(1);
  for (std::size_t i = 1; i < graph.map_from_node.size(); ++i)
    graph.edges.push_back(between(graph.map_from_node, i - 1, i));
  graph.edges.push_back(between(graph.map_from_node, 0, 80));
  EXPECT_LT(meanError(solvePoseGraph(graph, {}).map_from_node, graph.map_from_node), 1e-9);
}

TEST(SolvePoseGraph, ClosesLoopsThatDriftHasOpenedFarBeyondTheTolerance) {
  const std::vector<Pose2> truth = laps(3);
  const PoseGraph graph = noisyGraph(truth);
  ASSERT_GT(edgeChi2(graph.edges.back(), graph.map_from_node), 100.0);
  const PoseGraphSolution solution = solvePoseGraph(graph, {});
  EXPECT_LT(meanError(solution.map_from_node, truth), 0.5 * meanError(graph.map_from_node, truth));
  for (const double trust : solution.edge_trust) EXPECT_GT(trust, 0.5);
}

TEST(SolvePoseGraph, TwentyPercentOfFalseClosuresRaiseTheErrorByLessThanTenPercent) {
  const std::vector<Pose2> truth = laps(3);
  PoseGraph graph = noisyGraph(truth);
  const double error_without = meanError(solvePoseGraph(graph, {}).map_from_node, truth);
  Random random(7);
  const std::size_t true_count = (truth.size() - 80 + 3) / 4;
  const std::size_t first_false = graph.edges.size();
  const auto node = [&] {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(truth.size()));
  };
  while (graph.edges.size() - first_false < true_count / 4) {
    PoseEdge closure = graph.edges.back();
    closure.from = node();
    closure.to = node();
    if (closure.from == closure.to) continue;
    closure.from_from_to = {random.uniform() - 0.5, random.uniform() - 0.5, 6.0 * random.uniform()};
    graph.edges.push_back(closure);
  }
  const PoseGraphSolution solution = solvePoseGraph(graph, {});
  EXPECT_LT(meanError(solution.map_from_node, truth), 1.1 * error_without);
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    if (i < first_false) {
      EXPECT_GT(solution.edge_trust[i], 0.5) << i;
    } else {
      EXPECT_LT(solution.edge_trust[i], 0.5) << i;
    }
  }
}

TEST(SolvePoseGraph, GivesTheSameBitsTwice) {
  const PoseGraph graph = noisyGraph(laps(2));
  const PoseGraphSolution a = solvePoseGraph(graph, {});
  const PoseGraphSolution b = solvePoseGraph(graph, {});
  for (std::size_t i = 0; i < a.map_from_node.size(); ++i) {
    EXPECT_EQ(a.map_from_node[i].x_m, b.map_from_node[i].x_m);
    EXPECT_EQ(a.map_from_node[i].yaw_rad, b.map_from_node[i].yaw_rad);
  }
}

TEST(SolvePoseGraph, RefusesEdgesThatMakeNoSense) {
  PoseGraph graph;
  graph.map_from_node = {Pose2{}, Pose2{}};
  graph.edges = {PoseEdge{}};
  graph.edges[0].to = 2;
  EXPECT_THAT([&] { solvePoseGraph(graph, {}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("edge 0 - 2")));
  graph.edges[0].to = 1;
  graph.edges[0].from_from_to.x_m = NAN;
  EXPECT_THAT([&] { solvePoseGraph(graph, {}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not finite")));
}

TEST(SolvePoseGraph, LeavesAGraphWithoutEdgesAsItIs) {
  PoseGraph graph;
  graph.map_from_node = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  const PoseGraphSolution solution = solvePoseGraph(graph, {});
  ASSERT_EQ(solution.map_from_node.size(), 2U);
  EXPECT_EQ(solution.map_from_node[1].y_m, 5.0);
  EXPECT_TRUE(solution.edge_trust.empty());
}

TEST(SolvePoseGraph, WeighsTwoMeasurementsByTheirInformation) {
  // 1 m with information 3, 2 m with information 1: 1.25 m.
  PoseGraph graph;
  graph.map_from_node = {{}, {1.0, 0.0, 0.0}};
  graph.edges = {between(graph.map_from_node, 0, 1), between(graph.map_from_node, 0, 1)};
  graph.edges[0].information *= 3.0;
  graph.edges[1].from_from_to.x_m = 2.0;
  EXPECT_NEAR(solvePoseGraph(graph, {}).map_from_node[1].x_m, 1.25, 1e-4);
}

TEST(SolvePoseGraph, HoldsOnlyTheDirectionsOfASingularInformation) {
  PoseGraph graph;
  graph.map_from_node = {{}, {1.0, 0.5, 0.0}};
  graph.edges = {between(graph.map_from_node, 0, 1), between(graph.map_from_node, 0, 1)};
  graph.edges[1].from_from_to = {9.0, 0.7, 0.0};
  graph.edges[1].information.setZero();
  graph.edges[1].information(1, 1) = 1.0;  // nothing is known along x
  const Pose2 solved = solvePoseGraph(graph, {}).map_from_node[1];
  EXPECT_NEAR(solved.x_m, 1.0, 1e-4);
  EXPECT_NEAR(solved.y_m, 0.6, 1e-4);
}

TEST(SolvePoseGraph, TrustsAFalseClosureAsDynamicCovarianceScalingDoes) {
  // A closure that cannot move anything: trust = 2 Phi / (Phi + chi2).
  PoseGraph graph;
  graph.map_from_node = {{}, {1.0, 0.0, 0.0}};
  PoseEdge sure = between(graph.map_from_node, 0, 1);
  sure.information *= 1e12;
  PoseEdge closure = between(graph.map_from_node, 0, 1);
  closure.from_from_to.x_m += 5.0;
  closure.may_be_false = true;
  graph.edges = {sure, closure};
  PoseGraphParameters parameters;
  parameters.closure_tolerance_chi2 = 5.0;
  const PoseGraphSolution solution = solvePoseGraph(graph, parameters);
  EXPECT_EQ(solution.edge_trust[0], 1.0);
  EXPECT_NEAR(solution.edge_trust[1], 2.0 * 5.0 / (5.0 + 25.0), 1e-4);
}

TEST(EdgeChi2, IsTheSquaredMahalanobisDistanceInTheAxesOfTheStart) {
  PoseEdge edge;
  edge.from = 0;
  edge.to = 1;
  edge.from_from_to = {1.0, 0.0, 0.0};
  edge.information = Eigen::Vector3d(1.0, 10.0, 100.0).asDiagonal();
  // Seen from a pose that faces along y, the second is at (1.2, -0.3), turned by 0.1.
  const Pose2 from{4.0, 5.0, M_PI_2};
  const std::vector<Pose2> poses{from, from * Pose2{1.2, -0.3, 0.1}};
  EXPECT_NEAR(edgeChi2(edge, poses), 0.04 + 10.0 * 0.09 + 100.0 * 0.01, 1e-9);
}

TEST(EdgeChi2, TakesTheShorterWayRound) {
  PoseEdge edge;
  edge.to = 1;
  edge.from_from_to.yaw_rad = M_PI - 0.1;
  EXPECT_NEAR(edgeChi2(edge, {{}, {0.0, 0.0, -M_PI + 0.1}}), 0.04, 1e-9);
}

TEST(WithFloor, AddsCovariances) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.04, 0.09, 0.01).asDiagonal();
  const Eigen::Matrix3d left = withFloor(covariance.inverse(), 0.3, 0.2);
  const Eigen::Matrix3d wanted = Eigen::Vector3d(0.13, 0.18, 0.05).asDiagonal();
  EXPECT_TRUE(left.inverse().isApprox(wanted, 1e-9));
}

TEST(WithFloor, KeepsOpenDirectionsOpen) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information(1, 1) = 1e6;
  const Eigen::Matrix3d left = withFloor(information, 0.1, 0.1);
  EXPECT_EQ(left(0, 0), 0.0);
  EXPECT_NEAR(left(1, 1), 1.0 / (1e-6 + 0.01), 1e-6);
  EXPECT_EQ(left(2, 2), 0.0);
}

}  // namespace
}  // namespace ram_slam
