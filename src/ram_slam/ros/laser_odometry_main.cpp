// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include "laser_odometry_node.hpp"

int main(int argc, char** argv) {
  return ram_parameters_ros::runNode<ram_slam_ros::LaserOdometryNode>(
      argc, argv, "laser_odometry", "refines wheel odometry by laser scans");
}
