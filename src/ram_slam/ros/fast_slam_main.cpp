// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "fast_slam_node.hpp"

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<ram_slam_ros::FastSlamNode>(
      argc, argv, "fast_slam",
      "estimates the robot's pose and a map of landmarks from features and motion");
}
