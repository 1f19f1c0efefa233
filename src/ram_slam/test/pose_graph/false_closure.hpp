// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>

#include "ram_slam/pose_graph/pose_graph.hpp"

namespace ram_slam {

/// Along two corridors, there and back, without any error, with one false closure at the end.
/// \param weak_share  share of the edges that the walls hold less
/// \param angle_rad   by which the closure is turned
inline PoseGraph chainWithFalseClosure(std::size_t count, double weak_share, double angle_rad) {
  PoseGraph graph;
  graph.map_from_node.emplace_back();
  for (std::size_t i = 1; i < count; ++i) {
    const bool is_turn = i == count / 2 || i == count / 2 + 7;
    const bool is_weak = static_cast<double>(i % 100) < 100.0 * weak_share;
    PoseEdge edge;
    edge.from = i - 1;
    edge.to = i;
    edge.from_from_to = {0.3, 0.0, is_turn ? M_PI_2 : 0.0};
    const double deviation_m = is_weak ? 0.025 : 0.005;
    const double deviation_rad = is_weak ? 0.019 : 0.003;
    const Eigen::Vector3d deviations(deviation_m, deviation_m, deviation_rad);
    edge.information = deviations.cwiseAbs2().cwiseInverse().asDiagonal();
    graph.map_from_node.push_back(graph.map_from_node.back() * edge.from_from_to);
    graph.edges.push_back(edge);
  }
  PoseEdge closure;
  closure.from = count / 10;
  closure.to = count - 1 - count / 10;
  closure.may_be_false = true;
  const double yaw_rad =
      graph.map_from_node[closure.to].yaw_rad - graph.map_from_node[closure.from].yaw_rad;
  closure.from_from_to = {0.5, 0.2, wrapAngle(yaw_rad + angle_rad)};
  closure.information = Eigen::Vector3d(950.0, 300.0, 5000.0).asDiagonal();
  graph.edges.push_back(closure);
  return graph;
}

}  // namespace ram_slam
