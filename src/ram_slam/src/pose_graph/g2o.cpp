// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/pose_graph/g2o.hpp"

#include <cstddef>
#include <istream>
#include <limits>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ram_slam {
namespace {

Pose2 readPose(std::istream& words) {
  Pose2 pose;
  words >> pose.x_m >> pose.y_m >> pose.yaw_rad;
  return pose;
}

PoseEdge readEdge(std::istream& words) {
  PoseEdge edge;
  words >> edge.from >> edge.to;
  edge.from_from_to = readPose(words);
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      words >> edge.information(row, column);
      edge.information(column, row) = edge.information(row, column);
    }
  }
  return edge;
}

}  // namespace

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
      words >> id;
      graph.map_from_node.push_back(readPose(words));
      if (!words || id + 1 != graph.map_from_node.size()) {
        throw std::runtime_error("line " + std::to_string(number) +
                                 " is not the next vertex: " + line);
      }
    } else if (kind == "EDGE_SE2") {
      graph.edges.push_back(readEdge(words));
      if (!words)
        throw std::runtime_error("line " + std::to_string(number) + " is not an edge: " + line);
    }
  }
  return graph;
}

}  // namespace ram_slam
