// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "occupancy_mapper_node.hpp"

int main(int argc, char** argv) {
  constexpr int kThreads = 3;  // one maps while another publishes and a third answers services
  return ram_parameters_ros::runNode<ram_slam_ros::OccupancyMapperNode>(
      argc, argv, "occupancy_mapper", "draws an occupancy map from scans and tf", kThreads);
}
