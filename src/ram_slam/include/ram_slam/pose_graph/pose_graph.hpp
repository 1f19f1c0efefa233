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
  bool was_outvoted = false;        ///< such an edge that takes part only when all are judged again
};

struct PoseGraph {
  std::vector<Pose2> map_from_node;
  std::vector<PoseEdge> edges;
  /// The cost of the graph when its closures were judged last; they are judged again once it has
  /// risen by closure_cost_chi2, less than which no new closure can contradict the rest by.
  double judged_chi2 = 0.0;
};

struct PoseGraphSolution {
  std::vector<Pose2> map_from_node;
  /// Weight of each edge, 0 .. 1; 1 for edges that cannot be false.
  std::vector<double> edge_trust;
  double chi2 = 0.0;       ///< cost of the graph with the closures that are trusted
  bool is_judged = false;  ///< whether the cost of each closure was determined
};

/// Settings of the least squares over a graph.
struct PoseGraphParameters {
  /// Squared Mahalanobis distance up to which an uncertain edge has full weight: Phi in dynamic
  /// covariance scaling (Agarwal et al., ICRA 2013).
  double closure_tolerance_chi2 = 5.0;
  /// Quantile 0.999 of chi^2 of 3 degrees of freedom.
  double closure_cost_chi2 = 16.27;
  /// Beyond the range at which walls are compared; see DenseSearchParameters::max_range_m.
  double closure_beside_m = 12.0;
  double min_trust = 0.5;  ///< a closure of less weight in the graph is outvoted
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
/// Edges that may be false weigh less the less they agree (dynamic covariance scaling). One that
/// costs the others more than closure_cost_chi2 (see closureCosts()) is refused, and the graph is
/// solved as without it; its trust is what it would weigh there.
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
