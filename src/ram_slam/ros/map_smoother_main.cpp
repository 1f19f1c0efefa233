// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "map_smoother_node.hpp"

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<ram_slam_ros::MapSmootherNode>(
      argc, argv, "map_smoother", "closes loops and corrects the whole trajectory");
}
