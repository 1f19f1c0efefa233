// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "ram_slam/pose_graph/pose_graph.hpp"

namespace ram_slam {

/// Writes the graph in g2o's text format (VERTEX_SE2, EDGE_SE2, FIX of the first vertex).
void writeG2o(const PoseGraph& graph, std::ostream& out);

/// Reads what writeG2o() writes. \throws std::runtime_error naming the line that is damaged
PoseGraph readG2o(std::istream& in);

}  // namespace ram_slam
