// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/pose_graph/closure_costs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include "edge_error.hpp"

namespace ram_slam {
namespace {

/// 1 - leverage of a closure that alone holds a part of the graph; it costs nothing then.
constexpr double kLeastFreedom = 1e-9;

/// Whitened residual and derivatives of an edge.
struct LinearEdge {
  Eigen::Vector3d residual;
  Eigen::Matrix3d by_from;
  Eigen::Matrix3d by_to;
};

LinearEdge linearised(const PoseEdge& edge, const std::vector<Pose2>& poses) {
  const Pose2& a = poses[edge.from];
  const Pose2& b = poses[edge.to];
  const std::array<double, 3> from{a.x_m, a.y_m, a.yaw_rad};
  const std::array<double, 3> to{b.x_m, b.y_m, b.yaw_rad};
  const Eigen::Matrix3d root = squareRoot(edge.information);
  const EdgeJacobians jacobians = edgeJacobians(from.data(), to.data());
  return {root * edgeError(edge, from.data(), to.data()), root * jacobians.by_from,
          root * jacobians.by_to};
}

/// The path to each node along the edges between successive nodes [m].
std::vector<double> pathLengths(const PoseGraph& graph) {
  std::vector<double> steps_m(graph.map_from_node.size(), 0.0);
  for (const PoseEdge& edge : graph.edges) {
    if (!edge.may_be_false && edge.to == edge.from + 1)
      steps_m[edge.to] = edge.from_from_to.translation().norm();
  }
  for (std::size_t i = 1; i < steps_m.size(); ++i) steps_m[i] += steps_m[i - 1];
  return steps_m;
}

class CostsOfClosures {
public:
  CostsOfClosures(const PoseGraph& graph,
                  const std::vector<Pose2>& map_from_node,
                  const std::vector<bool>& is_left_out)
      : graph_(graph), is_left_out_(is_left_out), path_m_(pathLengths(graph)) {
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      edges_.push_back(linearised(graph.edges[i], map_from_node));
      if (graph.edges[i].may_be_false) closures_.push_back(i);
    }
  }

  std::vector<double> costs(double beside_m) {
    std::vector<double> costs(graph_.edges.size(), 0.0);
    if (closures_.empty()) return costs;
    factorise();
    findLeverages(2.0 * beside_m);
    for (std::size_t i = 0; i < closures_.size(); ++i)
      costs[closures_[i]] = costOf(closuresBeside(i, beside_m));
    return costs;
  }

private:
  /// J P of a closure, P being the covariance of all poses: 3 rows.
  using Influence = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  static Eigen::Index column(std::size_t node) { return 3 * static_cast<Eigen::Index>(node) - 3; }

  /// The normal equations; the first node stays where it is.
  void factorise() {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&entries](std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
      if (a == 0 || b == 0 || a < b) return;  // fixed, or of the upper triangle
      for (int row = 0; row < 3; ++row) {
        for (int col = 0; col < 3; ++col)
          entries.emplace_back(column(a) + row, column(b) + col, block(row, col));
      }
    };
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (is_left_out_[i]) continue;
      const LinearEdge& edge = edges_[i];
      const std::size_t from = graph_.edges[i].from;
      const std::size_t to = graph_.edges[i].to;
      add(from, from, edge.by_from.transpose() * edge.by_from);
      add(to, to, edge.by_to.transpose() * edge.by_to);
      add(from, to, edge.by_from.transpose() * edge.by_to);
      add(to, from, edge.by_to.transpose() * edge.by_from);
    }
    const Eigen::Index size = column(graph_.map_from_node.size());
    Eigen::SparseMatrix<double> normal(size, size);
    normal.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(normal);
    if (solver_.info() != Eigen::Success) throw std::runtime_error("pose graph is not connected");
  }

  /// Of each closure on itself and on those near it.
  void findLeverages(double near_m) {
    leverages_.resize(closures_.size());
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      const Influence influence = influenceOf(closures_[i]);
      for (const std::size_t j : closuresBeside(i, near_m))
        leverages_[i].emplace(j, leverage(influence, closures_[j]));
    }
  }

  Influence influenceOf(std::size_t closure) const {
    Eigen::MatrixX3d rows = Eigen::MatrixX3d::Zero(column(graph_.map_from_node.size()), 3);
    const PoseEdge& edge = graph_.edges[closure];
    if (edge.from > 0) rows.middleRows<3>(column(edge.from)) = edges_[closure].by_from.transpose();
    if (edge.to > 0) rows.middleRows<3>(column(edge.to)) = edges_[closure].by_to.transpose();
    return solver_.solve(rows).transpose();
  }

  /// J_i P J_j^T of two closures, from the influence of the first.
  Eigen::Matrix3d leverage(const Influence& influence, std::size_t closure) const {
    const PoseEdge& edge = graph_.edges[closure];
    const LinearEdge& linear = edges_[closure];
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    if (edge.from > 0)
      sum += influence.middleCols<3>(column(edge.from)) * linear.by_from.transpose();
    if (edge.to > 0) sum += influence.middleCols<3>(column(edge.to)) * linear.by_to.transpose();
    return sum;
  }

  /// The closure itself first.
  std::vector<std::size_t> closuresBeside(std::size_t i, double beside_m) const {
    const PoseEdge& edge = graph_.edges[closures_[i]];
    std::vector<std::size_t> beside{i};
    if (is_left_out_[closures_[i]]) return beside;
    for (std::size_t j = 0; j < closures_.size(); ++j) {
      const PoseEdge& other = graph_.edges[closures_[j]];
      if (j == i || is_left_out_[closures_[j]]) continue;
      if (std::abs(path_m_[edge.from] - path_m_[other.from]) <= beside_m &&
          std::abs(path_m_[edge.to] - path_m_[other.to]) <= beside_m)
        beside.push_back(j);
    }
    return beside;
  }

  /// \param taken_out  the closure itself first
  double costOf(const std::vector<std::size_t>& taken_out) const {
    const auto size = static_cast<Eigen::Index>(3 * taken_out.size());
    const double sign = is_left_out_[closures_[taken_out.front()]] ? 1.0 : -1.0;
    Eigen::MatrixXd freedom = Eigen::MatrixXd::Identity(size, size);
    Eigen::VectorXd residuals(size);
    for (std::size_t a = 0; a < taken_out.size(); ++a) {
      const auto row = static_cast<Eigen::Index>(3 * a);
      residuals.segment<3>(row) = edges_[closures_[taken_out[a]]].residual;
      for (std::size_t b = 0; b < taken_out.size(); ++b)
        freedom.block<3, 3>(row, static_cast<Eigen::Index>(3 * b)) +=
            sign * leverages_[taken_out[a]].at(taken_out[b]);
    }
    freedom.diagonal().array() += kLeastFreedom;
    const Eigen::LDLT<Eigen::MatrixXd> inverse(freedom);
    // Left out already: r is the misfit and I + H its covariance.
    if (sign > 0.0) return residuals.dot(inverse.solve(residuals));
    const Eigen::Vector3d misfit = inverse.solve(residuals).head<3>();
    const Eigen::MatrixXd first = Eigen::MatrixXd::Identity(size, 3);
    const Eigen::Matrix3d covariance = inverse.solve(first).topRows<3>();
    return misfit.dot(covariance.ldlt().solve(misfit));
  }

  const PoseGraph& graph_;
  const std::vector<bool>& is_left_out_;
  std::vector<double> path_m_;
  std::vector<LinearEdge> edges_;
  std::vector<std::size_t> closures_;
  std::vector<std::map<std::size_t, Eigen::Matrix3d>> leverages_;  // by places in closures_
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace

std::vector<double> closureCosts(const PoseGraph& graph,
                                 const std::vector<Pose2>& map_from_node,
                                 const std::vector<bool>& is_left_out,
                                 double beside_m) {
  return CostsOfClosures(graph, map_from_node, is_left_out).costs(beside_m);
}

}  // namespace ram_slam
