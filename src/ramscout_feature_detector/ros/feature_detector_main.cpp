// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "feature_detector_node.hpp"

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<ramscout_feature_detector_ros::FeatureDetectorNode>(
      argc, argv, "feature_detector", "finds corners in laser scans");
}
