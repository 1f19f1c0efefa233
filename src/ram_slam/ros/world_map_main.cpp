// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "world_map_node.hpp"

int main(int argc, char** argv) {
  constexpr int kThreads = 2;  // one writes or reads a file while the other serves messages
  return ram_parameters_ros::runNode<ram_slam_ros::WorldMapNode>(
      argc, argv, "world_map", "keeps the belief about the world: region queries, save, load",
      kThreads);
}
