// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "kinematics_node.hpp"

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<ramscout_kinematics_ros::KinematicsNode>(
      argc, argv, "kinematics",
      "answers how the robot moved between two stamps, from buffered odometry");
}
