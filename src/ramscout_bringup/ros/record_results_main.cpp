// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <exception>
#include <iostream>

#include <ram_parameters/ros/parameter_server.hpp>
#include <ros/ros.h>

#include "results_recorder.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "record_results");
  ros::NodeHandle keeps_logging_alive;
  try {
    auto reader = ram_parameters_ros::privateParameters();
    ramscout_bringup_ros::ResultsRecorder recorder(
        ramscout_bringup_ros::readResultsRecorderParameters(reader));
    const bool good = recorder.run();
    std::cout << (good ? "VERDICT: good" : "VERDICT: bad, the estimate is out of bounds")
              << std::endl;
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& error) {
    std::cout << "VERDICT: failed, " << error.what() << std::endl;
    return EXIT_FAILURE;
  }
}
