// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/pose_graph/g2o.hpp"

#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

PoseGraph twoPoses() {
  PoseGraph graph;
  graph.map_from_node = {{0.1, -1.0 / 3.0, 0.2}, {1e-7, 12345.678901234567, -3.0}};
  PoseEdge edge;
  edge.from = 0;
  edge.to = 1;
  edge.from_from_to = {2.0 / 3.0, 0.5, -0.25};
  edge.information << 4.0, 1.0 / 3.0, 0.5, 1.0 / 3.0, 5.0, 0.25, 0.5, 0.25, 6.0;
  graph.edges = {edge};
  return graph;
}

TEST(G2o, ReadsBackTheBitsThatItWrote) {
  const PoseGraph graph = twoPoses();
  std::stringstream file;
  writeG2o(graph, file);
  const PoseGraph read = readG2o(file);
  ASSERT_EQ(read.map_from_node.size(), 2U);
  ASSERT_EQ(read.edges.size(), 1U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.map_from_node[i].x_m, graph.map_from_node[i].x_m);
    EXPECT_EQ(read.map_from_node[i].y_m, graph.map_from_node[i].y_m);
    EXPECT_EQ(read.map_from_node[i].yaw_rad, graph.map_from_node[i].yaw_rad);
  }
  EXPECT_EQ(read.edges[0].information, graph.edges[0].information);
  EXPECT_EQ(read.edges[0].from_from_to.x_m, graph.edges[0].from_from_to.x_m);
}

TEST(G2o, FixesTheFirstVertexAndWritesTheUpperTriangle) {
  std::ostringstream file;
  writeG2o(twoPoses(), file);
  EXPECT_THAT(file.str(), HasSubstr("\nFIX 0\n"));
  EXPECT_THAT(file.str(), HasSubstr("EDGE_SE2 0 1 "));
  EXPECT_THAT(file.str(), HasSubstr(" 0.5 5 0.25 6\n"));
}

TEST(G2o, IsEmptyForAnEmptyGraph) {
  std::stringstream file;
  writeG2o({}, file);
  EXPECT_EQ(file.str(), "");
  EXPECT_TRUE(readG2o(file).map_from_node.empty());
}

TEST(G2o, NamesTheLineThatIsDamaged) {
  std::istringstream edge("VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 zero\n");
  EXPECT_THAT([&] { readG2o(edge); },
              ThrowsMessage<std::runtime_error>(HasSubstr("line 2 is not an edge")));
  std::istringstream vertex("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 7 0 0 0\n");
  EXPECT_THAT([&] { readG2o(vertex); },
              ThrowsMessage<std::runtime_error>(HasSubstr("line 2 is not the next vertex")));
}

}  // namespace
}  // namespace ram_slam
