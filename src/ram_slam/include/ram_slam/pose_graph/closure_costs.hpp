// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "ram_slam/pose_graph/pose_graph.hpp"

namespace ram_slam {

/// What the closures of a solved graph cost its other edges.
///
/// The cost of a closure is the difference of the least sums of squares with and without it, once
/// the closures beside it are taken out, which repeat the same reading of the same walls. With
/// d the misfit of the closure in the graph without them and S its covariance there, closure
/// included, it is d^T S^-1 d: chi^2 of 3 degrees of freedom if the closure is right (2 if it holds
/// 2 directions only). All are found from one factorisation of the normal equations, linearised at
/// the given poses: with the whitened residuals r of a set of closures and their leverage H =
/// J P J^T, the set taken out leaves d = (I - H)^-1 r with covariance (I - H)^-1 (Cook and
/// Weisberg, Residuals and Influence in Regression, 1982, section 2.2).
///
/// \param is_left_out  of each edge: not part of the solved graph; what a closure would cost that
/// is
///   left out is found in the same way: (I + H) is then the covariance of its misfit r
/// \param beside_m  closures are beside each other if their ends are so near along the path, each
/// \return for each edge; 0 for edges that cannot be false
/// \throws std::runtime_error if the edges do not connect all nodes
std::vector<double> closureCosts(const PoseGraph& graph,
                                 const std::vector<Pose2>& map_from_node,
                                 const std::vector<bool>& is_left_out,
                                 double beside_m);

}  // namespace ram_slam
