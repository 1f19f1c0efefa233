// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "edge_detector_node.hpp"

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<ramscout_feature_detector_ros::EdgeDetectorNode>(
      argc, argv, "edge_detector", "finds edges of things in laser scans");
}
