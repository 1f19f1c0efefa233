// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "landmark_smoother_node.hpp"

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<ram_slam_ros::LandmarkSmootherNode>(
      argc, argv, "landmark_smoother", "smooths landmarks and trajectory of ambiguous features");
}
