// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// A relative pose that was measured between two poses of a graph.
struct PoseEdge {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose2 from_from_to;  ///< the pose `to`, seen from the pose `from`
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Identity();  ///< of x, y, yaw in the axes of `from`
  bool may_be_false = false;        ///< a loop closure: a robust kernel guards against it
};

struct PoseGraph {
  std::vector<Pose2> map_from_node;
  std::vector<PoseEdge> edges;
};

struct PoseGraphSolution {
  std::vector<Pose2> map_from_node;
  /// Weight of each edge, 0 .. 1; 1 for edges that cannot be false.
  std::vector<double> edge_trust;
};

/// Settings of the least squares over a graph.
struct PoseGraphParameters {
  /// Squared Mahalanobis distance up to which an uncertain edge has full weight: Phi in dynamic
  /// covariance scaling (Agarwal et al., ICRA 2013).
  double closure_tolerance_chi2 = 5.0;
  int max_iterations = 20;
  double precision = 1e-7;        ///< relative change of the cost at which the solution is final
  double rough_precision = 1e-4;  ///< the same of the solutions before the last
  double tolerance_step = 8.0;    ///< by which the tolerance shrinks from solution to solution

  static const ram_parameters::ParameterTable<PoseGraphParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// The poses that agree best with the edges: the least sum of e^T information e with
/// e = (R_i^T (t_j - t_i) - t_ij, yaw_j - yaw_i - yaw_ij), the first pose staying where it is.
/// Edges that may be false weigh less the less they agree (dynamic covariance scaling).
///
/// \throws std::invalid_argument if an edge names a node that is not there or carries a number that
/// is not finite \throws std::runtime_error if the solver fails
PoseGraphSolution solvePoseGraph(const PoseGraph& graph, const PoseGraphParameters& parameters);

/// The information left when independent errors of these deviations are added: (C + D)^-1 for D =
/// diag(deviation_m^2, deviation_m^2, deviation_rad^2), from C^-1, which may be singular: walls
/// leave directions open.
Eigen::Matrix3d withFloor(const Eigen::Matrix3d& information,
                          double deviation_m,
                          double deviation_rad);

/// Squared Mahalanobis distance of an edge at given poses.
double edgeChi2(const PoseEdge& edge, const std::vector<Pose2>& map_from_node);

}  // namespace ram_slam
