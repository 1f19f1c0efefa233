// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"
#include "ramscout_sim/ros/simulator_node.hpp"

int main(int argc, char** argv) {
  // Callbacks overlap: a step that waits for the lock step's answers must not keep them from being
  // heard.
  constexpr int kThreads = 3;
  return ram_parameters_ros::runNode<ramscout_sim_ros::SimulatorNode>(
      argc, argv, "simulator",
      "a robot with wheels and a lidar among walls: clock, scan, odom, tf, ground truth", kThreads);
}
