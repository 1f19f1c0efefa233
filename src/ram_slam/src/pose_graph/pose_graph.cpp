// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/pose_graph/pose_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <ceres/ceres.h>

#include "ram_slam/pose_graph/closure_costs.hpp"

#include "edge_error.hpp"
#include "least_squares.hpp"

namespace ram_slam {
namespace {

using Parameters = std::array<double, 3>;

class EdgeCost : public ceres::SizedCostFunction<3, 3, 3> {
public:
  explicit EdgeCost(const PoseEdge& edge) : edge_(edge), root_(squareRoot(edge.information)) {}

  bool Evaluate(const double* const* poses, double* residuals, double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const double* from = poses[0];
    const double* to = poses[1];
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = root_ * edgeError(edge_, from, to);
    if (jacobians == nullptr) return true;
    const EdgeJacobians by = edgeJacobians(from, to);
    if (jacobians[0] != nullptr) {
      Eigen::Map<RowMajor> jacobian(jacobians[0]);
      jacobian = root_ * by.by_from;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<RowMajor> jacobian(jacobians[1]);
      jacobian = root_ * by.by_to;
    }
    return true;
  }

private:
  PoseEdge edge_;
  Eigen::Matrix3d root_;
};

/// The weight of an edge in dynamic covariance scaling.
double trust(double chi2, double tolerance_chi2) {
  return std::min(1.0, 2.0 * tolerance_chi2 / (tolerance_chi2 + chi2));
}

/// The kernel whose weight is trust() squared: chi2 up to the tolerance, bounded beyond.
class DynamicCovarianceScaling : public ceres::LossFunction {
public:
  explicit DynamicCovarianceScaling(double tolerance_chi2) : tolerance_(tolerance_chi2) {}

  void Evaluate(double chi2, double out[3]) const override {
    if (chi2 <= tolerance_) {
      out[0] = chi2;
      out[1] = 1.0;
      out[2] = 0.0;
      return;
    }
    const double sum = tolerance_ + chi2;
    out[0] = tolerance_ * (3.0 * chi2 - tolerance_) / sum;
    out[1] = 4.0 * tolerance_ * tolerance_ / (sum * sum);
    out[2] = -2.0 * out[1] / sum;
  }

private:
  double tolerance_;
};

void check(const PoseGraph& graph) {
  for (const PoseEdge& edge : graph.edges) {
    const std::size_t count = graph.map_from_node.size();
    if (edge.from >= count || edge.to >= count || edge.from == edge.to) {
      throw std::invalid_argument("edge " + std::to_string(edge.from) + " - " +
                                  std::to_string(edge.to) + " in a graph of " +
                                  std::to_string(count) + " nodes");
    }
    if (!edge.from_from_to.isFinite() || !edge.information.allFinite()) {
      throw std::invalid_argument("edge " + std::to_string(edge.from) + " - " +
                                  std::to_string(edge.to) + " is not finite");
    }
  }
}

std::vector<Parameters> toParameters(const std::vector<Pose2>& poses) {
  std::vector<Parameters> parameters;
  parameters.reserve(poses.size());
  for (const Pose2& pose : poses) parameters.push_back({pose.x_m, pose.y_m, pose.yaw_rad});
  return parameters;
}

/// One least-squares problem, from given poses, with one tolerance for the edges that may be false.
std::vector<Pose2> solve(const PoseGraph& graph,
                         double tolerance_chi2,
                         int max_iterations,
                         double precision) {
  std::vector<Parameters> poses = toParameters(graph.map_from_node);
  ceres::Problem problem;
  for (const PoseEdge& edge : graph.edges) {
    ceres::LossFunction* kernel =
        edge.may_be_false
            ? static_cast<ceres::LossFunction*>(new DynamicCovarianceScaling(tolerance_chi2))
            : nullptr;
    problem.AddResidualBlock(new EdgeCost(edge), kernel, poses[edge.from].data(),
                             poses[edge.to].data());
  }
  problem.AddParameterBlock(poses.front().data(), 3);
  problem.SetParameterBlockConstant(poses.front().data());

  solveLeastSquares(problem, max_iterations, precision, "pose graph not solved");

  std::vector<Pose2> solution;
  for (const Parameters& pose : poses) solution.push_back({pose[0], pose[1], wrapAngle(pose[2])});
  return solution;
}

}  // namespace

const ram_parameters::ParameterTable<PoseGraphParameters>& PoseGraphParameters::table() {
  using namespace ram_parameters;
  using P = PoseGraphParameters;
  static const auto table =
      ParameterTable<P>()
          .add("closure_tolerance_chi2", &P::closure_tolerance_chi2, "", positive(),
               "Squared Mahalanobis distance up to which a closure has full weight.")
          .add("graph_max_iterations", &P::max_iterations, "", atLeast(1),
               "Most iterations of one solution of the graph.")
          .add("closure_cost_chi2", &P::closure_cost_chi2, "", positive(),
               "Greatest cost of a closure to the rest of the graph; the default is exceeded once "
               "in a thousand true closures (chi^2 of 3 degrees of freedom).")
          .add("closure_beside_m", &P::closure_beside_m, "m", atLeast(0.0),
               "Closures so near each other along both passages see the same walls: they do not "
               "support each other.")
          .expert("Precision of the pose graph")
          .add("graph_precision", &P::precision, "", positive(),
               "Relative change of the cost at which the last solution ends.")
          .add("graph_rough_precision", &P::rough_precision, "", positive(),
               "The same for the solutions before, which tolerate more.")
          .add("graph_tolerance_step", &P::tolerance_step, "", above(1.0),
               "By what the tolerance of closures is divided from one solution to the next.")
          .add("closure_min_trust", &P::min_trust, "", within(0.0, 1.0),
               "A closure of less weight in the pose graph is outvoted.");
  return table;
}

namespace {

/// The largest squared Mahalanobis distance of an edge that may be false; 0 without any.
double largestDoubtfulChi2(const PoseGraph& graph) {
  double largest = 0.0;
  for (const PoseEdge& edge : graph.edges) {
    if (edge.may_be_false) largest = std::max(largest, edgeChi2(edge, graph.map_from_node));
  }
  return largest;
}

/// Graduated (Yang et al., RA-L 2020): at first every edge has full weight, then ever less error
/// is tolerated. A true closure of a long loop would otherwise be rejected for the drift that it
/// is there to correct.
std::vector<Pose2> solveGraduated(PoseGraph graph, const PoseGraphParameters& parameters) {
  double tolerance_chi2 = std::max(parameters.closure_tolerance_chi2, largestDoubtfulChi2(graph));
  while (true) {
    const bool is_last = tolerance_chi2 <= parameters.closure_tolerance_chi2;
    graph.map_from_node = solve(graph, tolerance_chi2, parameters.max_iterations,
                                is_last ? parameters.precision : parameters.rough_precision);
    if (is_last) return std::move(graph.map_from_node);
    tolerance_chi2 =
        std::max(parameters.closure_tolerance_chi2,
                 std::min(largestDoubtfulChi2(graph), tolerance_chi2) / parameters.tolerance_step);
  }
}

/// The poses that the edges between successive nodes give which cannot be false; where there is
/// none, a node keeps its place beside the one before.
std::vector<Pose2> chainPoses(const PoseGraph& graph) {
  std::vector<Pose2> poses = graph.map_from_node;
  std::vector<const PoseEdge*> edge_to(poses.size(), nullptr);
  for (const PoseEdge& edge : graph.edges) {
    if (!edge.may_be_false && edge.to == edge.from + 1) edge_to[edge.to] = &edge;
  }
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose2 given = graph.map_from_node[i - 1].inverse() * graph.map_from_node[i];
    poses[i] = poses[i - 1] * (edge_to[i] != nullptr ? edge_to[i]->from_from_to : given);
  }
  return poses;
}

/// The solution of a graph without the closures that do not agree with the rest of it.
class ConsistentSolution {
public:
  ConsistentSolution(const PoseGraph& graph, const PoseGraphParameters& parameters)
      : graph_(graph),
        parameters_(parameters),
        is_out_(graph.edges.size(), false),
        is_refused_(graph.edges.size(), false),
        was_readmitted_(graph.edges.size(), false) {
    for (std::size_t i = 0; i < graph.edges.size(); ++i) is_out_[i] = graph.edges[i].was_outvoted;
    solveFrom(graph.map_from_node);
  }

  PoseGraphSolution take() {
    const bool has_distrusted = takeOutDistrusted();
    if (has_distrusted || solution_.chi2 > graph_.judged_chi2 + parameters_.closure_cost_chi2)
      judge();
    return std::move(solution_);
  }

private:
  /// Of all closures, those too that were outvoted before: they may support each other by now.
  void judge() {
    std::fill(is_out_.begin(), is_out_.end(), false);
    solveFrom(chainPoses(graph_));
    takeOutDistrusted();
    do {
      refuseCostly();
    } while (readmitCheap());
    solution_.is_judged = true;
  }

  /// Trust and cost at the poses of the solution.
  void weigh() {
    solution_.edge_trust.assign(graph_.edges.size(), 1.0);
    solution_.chi2 = 0.0;
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      const double chi2 = edgeChi2(graph_.edges[i], solution_.map_from_node);
      if (graph_.edges[i].may_be_false)
        solution_.edge_trust[i] = trust(chi2, parameters_.closure_tolerance_chi2);
      if (is_refused_[i]) solution_.edge_trust[i] = 0.0;
      if (!is_out_[i]) solution_.chi2 += chi2;
    }
  }

  void solveFrom(const std::vector<Pose2>& poses) {
    PoseGraph rest;
    rest.map_from_node = poses;
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      if (is_out_[i]) continue;
      rest.edges.push_back(graph_.edges[i]);
      // The kernel left it out although it costs little: it is in another minimum.
      if (was_readmitted_[i]) rest.edges.back().may_be_false = false;
    }
    solution_.map_from_node = solveGraduated(std::move(rest), parameters_);
    weigh();
  }

  /// Closures of little weight still pull. \return whether there were any
  bool takeOutDistrusted() {
    bool found = false;
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      if (is_out_[i] || solution_.edge_trust[i] >= parameters_.min_trust) continue;
      is_out_[i] = true;
      found = true;
    }
    // From the chain, as they may have bent the poses.
    if (found) solveFrom(chainPoses(graph_));
    return found;
  }

  std::vector<double> costs() const {
    return closureCosts(graph_, solution_.map_from_node, is_out_, parameters_.closure_beside_m);
  }

  /// Takes out the closure that costs the others most until none costs too much.
  void refuseCostly() {
    while (true) {
      std::vector<double> cost = costs();
      for (std::size_t i = 0; i < cost.size(); ++i) {
        if (is_out_[i]) cost[i] = 0.0;
      }
      const auto costliest = std::max_element(cost.begin(), cost.end());
      if (costliest == cost.end() || *costliest <= parameters_.closure_cost_chi2) return;
      const auto refused = static_cast<std::size_t>(costliest - cost.begin());
      is_out_[refused] = true;
      is_refused_[refused] = true;
      solveFrom(chainPoses(graph_));
      takeOutDistrusted();
    }
  }

  /// Closures that were taken out together with one that bent the poses may agree now.
  bool readmitCheap() {
    const std::vector<double> cost = costs();
    bool found = false;
    for (std::size_t i = 0; i < cost.size(); ++i) {
      if (!is_out_[i] || was_readmitted_[i]) continue;
      if (cost[i] > parameters_.closure_cost_chi2) continue;
      is_out_[i] = false;
      is_refused_[i] = false;
      was_readmitted_[i] = true;
      found = true;
    }
    if (!found) return false;
    solveFrom(chainPoses(graph_));
    takeOutDistrusted();
    return true;
  }

  const PoseGraph& graph_;
  const PoseGraphParameters& parameters_;
  std::vector<bool> is_out_;
  std::vector<bool> is_refused_;
  std::vector<bool> was_readmitted_;
  PoseGraphSolution solution_;
};

bool hasDoubtfulEdges(const PoseGraph& graph) {
  return std::any_of(graph.edges.begin(), graph.edges.end(),
                     [](const PoseEdge& edge) { return edge.may_be_false; });
}

}  // namespace

PoseGraphSolution solvePoseGraph(const PoseGraph& graph, const PoseGraphParameters& parameters) {
  check(graph);
  if (hasDoubtfulEdges(graph)) return ConsistentSolution(graph, parameters).take();
  PoseGraphSolution solution;
  solution.edge_trust.assign(graph.edges.size(), 1.0);
  solution.map_from_node =
      graph.edges.empty() ? graph.map_from_node : solveGraduated(graph, parameters);
  return solution;
}

Eigen::Matrix3d withFloor(const Eigen::Matrix3d& information,
                          double deviation_m,
                          double deviation_rad) {
  const Eigen::Vector3d deviations(deviation_m, deviation_m, deviation_rad);
  const Eigen::Matrix3d floor = deviations.cwiseAbs2().asDiagonal();
  return information * (Eigen::Matrix3d::Identity() + floor * information).inverse();
}

double edgeChi2(const PoseEdge& edge, const std::vector<Pose2>& map_from_node) {
  const Pose2& from = map_from_node[edge.from];
  const Pose2& to = map_from_node[edge.to];
  const Parameters a{from.x_m, from.y_m, from.yaw_rad};
  const Parameters b{to.x_m, to.y_m, to.yaw_rad};
  const Eigen::Vector3d error = edgeError(edge, a.data(), b.data());
  return error.dot(edge.information * error);
}

}  // namespace ram_slam
