// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <ros/ros.h>

#include "ram_parameters/ros/graph_reporter.hpp"
#include "ram_parameters/ros/parameter_server.hpp"

namespace ram_parameters_ros {

/// From now on Ctrl-C (SIGINT, with which roslaunch ends a launch) shuts ROS down, and is
/// remembered.
void handleInterrupts();
/// Whether SIGINT came: this is the end of the launch, not of this node alone.
bool wasInterrupted();

/// What every node's main does: starts the node, hands it its private parameters, and serves
/// callbacks until shutdown.
///
/// An exception from the node's constructor ends the process with one FATAL line and EXIT_FAILURE.
/// So does a master that was started again and does not know the node.
///
/// \tparam Node  constructible from a ram_parameters::ParameterReader&
/// \param description  one line, printed with --help
/// \param threads  callback threads of the spinner; 1 means callbacks never overlap
template <typename Node>
int runNode(int argc,
            char** argv,
            const std::string& name,
            const std::string& description,
            int threads = 1) {
  if (argc > 1 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h")) {
    std::cout << name << ": " << description << "\nParameters are private and documented in config/"
              << name << ".yaml; topics and services in docs/architecture.md.\n";
    return EXIT_SUCCESS;
  }
  ros::init(argc, argv, name, ros::init_options::NoSigintHandler);
  handleInterrupts();
  ros::NodeHandle keeps_logging_alive;  // rosconsole is mute once the last handle is gone
  try {
    ram_parameters::ParameterReader reader = privateParameters();
    Node node(reader);
    const GraphReporter graph;
    ros::MultiThreadedSpinner(static_cast<std::uint32_t>(threads)).spin();
    if (graph.hasEnded()) return EXIT_FAILURE;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace ram_parameters_ros
