// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/pose_graph/pose_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>

#include "least_squares.hpp"

namespace ram_slam {
namespace {

using Parameters = std::array<double, 3>;

Eigen::Vector3d edgeError(const PoseEdge& edge, const double* from, const double* to) {
  const double c = std::cos(from[2]);
  const double s = std::sin(from[2]);
  const double dx = to[0] - from[0];
  const double dy = to[1] - from[1];
  return {c * dx + s * dy - edge.from_from_to.x_m, -s * dx + c * dy - edge.from_from_to.y_m,
          wrapAngle(to[2] - from[2] - edge.from_from_to.yaw_rad)};
}

/// L^T with information = L L^T; also for singular information, of which a corridor's edges have
/// some.
Eigen::Matrix3d squareRoot(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

class EdgeCost : public ceres::SizedCostFunction<3, 3, 3> {
public:
  explicit EdgeCost(const PoseEdge& edge) : edge_(edge), root_(squareRoot(edge.information)) {}

  bool Evaluate(const double* const* poses, double* residuals, double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const double* from = poses[0];
    const double* to = poses[1];
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = root_ * edgeError(edge_, from, to);
    if (jacobians == nullptr) return true;
    const double c = std::cos(from[2]);
    const double s = std::sin(from[2]);
    const double dx = to[0] - from[0];
    const double dy = to[1] - from[1];
    if (jacobians[0] != nullptr) {
      RowMajor by_from;
      by_from << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy, 0.0, 0.0, -1.0;
      Eigen::Map<RowMajor> jacobian(jacobians[0]);
      jacobian = root_ * by_from;
    }
    if (jacobians[1] != nullptr) {
      RowMajor by_to;
      by_to << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
      Eigen::Map<RowMajor> jacobian(jacobians[1]);
      jacobian = root_ * by_to;
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
          .expert("Precision of the pose graph")
          .add("graph_precision", &P::precision, "", positive(),
               "Relative change of the cost at which the last solution ends.")
          .add("graph_rough_precision", &P::rough_precision, "", positive(),
               "The same for the solutions before, which tolerate more.")
          .add("graph_tolerance_step", &P::tolerance_step, "", above(1.0),
               "By what the tolerance of closures is divided from one solution to the next.");
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

}  // namespace

PoseGraphSolution solvePoseGraph(const PoseGraph& graph, const PoseGraphParameters& parameters) {
  check(graph);
  PoseGraphSolution solution;
  solution.edge_trust.assign(graph.edges.size(), 1.0);
  solution.map_from_node = graph.map_from_node;
  if (graph.edges.empty()) return solution;

  // Graduated (Yang et al., RA-L 2020): at first every edge has full weight, then ever less error
  // is tolerated. A true closure of a long loop would otherwise be rejected for the drift that it
  // is there to correct.
  PoseGraph solved = graph;
  double tolerance_chi2 = std::max(parameters.closure_tolerance_chi2, largestDoubtfulChi2(solved));
  while (true) {
    const bool is_last = tolerance_chi2 <= parameters.closure_tolerance_chi2;
    solved.map_from_node = solve(solved, tolerance_chi2, parameters.max_iterations,
                                 is_last ? parameters.precision : parameters.rough_precision);
    if (is_last) break;
    tolerance_chi2 =
        std::max(parameters.closure_tolerance_chi2,
                 std::min(largestDoubtfulChi2(solved), tolerance_chi2) / parameters.tolerance_step);
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    if (!graph.edges[i].may_be_false) continue;
    solution.edge_trust[i] =
        trust(edgeChi2(graph.edges[i], solved.map_from_node), parameters.closure_tolerance_chi2);
  }
  solution.map_from_node = std::move(solved.map_from_node);
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
