// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/pose_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <istream>
#include <limits>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>

#include "least_squares.hpp"

namespace ram_slam {
namespace {

using Parameters = std::array<double, 3>;

// Relative change of the cost at which a solution is good enough, the last and those on the way.
constexpr double kPrecise = 1e-7;
constexpr double kRough = 1e-4;
constexpr double kGraduation = 8.0;  // by which the tolerance shrinks from one solution to the next

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

/// How far dynamic covariance scaling believes an edge.
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
std::vector<Pose2> solve(const std::vector<PoseEdge>& edges,
                         const std::vector<Pose2>& map_from_node,
                         double tolerance_chi2,
                         int max_iterations,
                         double function_tolerance) {
  std::vector<Parameters> poses = toParameters(map_from_node);
  ceres::Problem problem;
  for (const PoseEdge& edge : edges) {
    ceres::LossFunction* kernel =
        edge.may_be_false
            ? static_cast<ceres::LossFunction*>(new DynamicCovarianceScaling(tolerance_chi2))
            : nullptr;
    problem.AddResidualBlock(new EdgeCost(edge), kernel, poses[edge.from].data(),
                             poses[edge.to].data());
  }
  problem.AddParameterBlock(poses.front().data(), 3);
  problem.SetParameterBlockConstant(poses.front().data());

  solveLeastSquares(problem, max_iterations, function_tolerance, "pose graph not solved");

  std::vector<Pose2> solution;
  for (const Parameters& pose : poses) solution.push_back({pose[0], pose[1], wrapAngle(pose[2])});
  return solution;
}

}  // namespace

void PoseGraphParameters::validate() const {
  if (!(closure_tolerance_chi2 > 0.0)) {
    throw std::invalid_argument("closure_tolerance_chi2 must be > 0, got " +
                                std::to_string(closure_tolerance_chi2));
  }
  if (max_iterations < 1) {
    throw std::invalid_argument("max_iterations must be >= 1, got " +
                                std::to_string(max_iterations));
  }
}

PoseGraphSolution solvePoseGraph(const PoseGraph& graph, const PoseGraphParameters& parameters) {
  check(graph);
  PoseGraphSolution solution;
  solution.map_from_node = graph.map_from_node;
  solution.edge_trust.assign(graph.edges.size(), 1.0);
  if (graph.edges.empty()) return solution;

  // Graduated (Yang et al., RA-L 2020): at first every edge is believed, then ever less
  // disagreement is tolerated. A true closure of a long loop would otherwise be disbelieved for the
  // drift that it is there to correct.
  double tolerance_chi2 = parameters.closure_tolerance_chi2;
  for (const PoseEdge& edge : graph.edges) {
    if (edge.may_be_false)
      tolerance_chi2 = std::max(tolerance_chi2, edgeChi2(edge, graph.map_from_node));
  }
  while (true) {
    const bool is_last = tolerance_chi2 <= parameters.closure_tolerance_chi2;
    solution.map_from_node = solve(graph.edges, solution.map_from_node, tolerance_chi2,
                                   parameters.max_iterations, is_last ? kPrecise : kRough);
    if (is_last) break;
    double largest_chi2 = 0.0;
    for (const PoseEdge& edge : graph.edges) {
      if (edge.may_be_false)
        largest_chi2 = std::max(largest_chi2, edgeChi2(edge, solution.map_from_node));
    }
    tolerance_chi2 = std::max(parameters.closure_tolerance_chi2,
                              std::min(largest_chi2, tolerance_chi2) / kGraduation);
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    if (!graph.edges[i].may_be_false) continue;
    solution.edge_trust[i] =
        trust(edgeChi2(graph.edges[i], solution.map_from_node), parameters.closure_tolerance_chi2);
  }
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

void writeG2o(const PoseGraph& graph, std::ostream& out) {
  const auto precision = out.precision(std::numeric_limits<double>::max_digits10);
  for (std::size_t i = 0; i < graph.map_from_node.size(); ++i) {
    const Pose2& pose = graph.map_from_node[i];
    out << "VERTEX_SE2 " << i << ' ' << pose.x_m << ' ' << pose.y_m << ' ' << pose.yaw_rad << '\n';
  }
  if (!graph.map_from_node.empty()) out << "FIX 0\n";
  for (const PoseEdge& edge : graph.edges) {
    out << "EDGE_SE2 " << edge.from << ' ' << edge.to << ' ' << edge.from_from_to.x_m << ' '
        << edge.from_from_to.y_m << ' ' << edge.from_from_to.yaw_rad;
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) out << ' ' << edge.information(row, column);
    }
    out << '\n';
  }
  out.precision(precision);
}

PoseGraph readG2o(std::istream& in) {
  PoseGraph graph;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "VERTEX_SE2") {
      std::size_t id = 0;
      Pose2 pose;
      words >> id >> pose.x_m >> pose.y_m >> pose.yaw_rad;
      if (!words || id != graph.map_from_node.size()) {
        throw std::runtime_error("line " + std::to_string(number) +
                                 " is not the next vertex: " + line);
      }
      graph.map_from_node.push_back(pose);
    } else if (kind == "EDGE_SE2") {
      PoseEdge edge;
      words >> edge.from >> edge.to >> edge.from_from_to.x_m >> edge.from_from_to.y_m >>
          edge.from_from_to.yaw_rad;
      for (int row = 0; row < 3; ++row) {
        for (int column = row; column < 3; ++column) {
          words >> edge.information(row, column);
          edge.information(column, row) = edge.information(row, column);
        }
      }
      if (!words)
        throw std::runtime_error("line " + std::to_string(number) + " is not an edge: " + line);
      graph.edges.push_back(edge);
    }
  }
  return graph;
}

}  // namespace ram_slam
