// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/ros/run_node.hpp"

#include <csignal>

namespace ram_parameters_ros {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void onInterrupt(int /*signal*/) {
  interrupted = 1;
  ros::requestShutdown();
}

}  // namespace

void handleInterrupts() {
  std::signal(SIGINT, onInterrupt);
}

bool wasInterrupted() {
  return interrupted != 0;
}

}  // namespace ram_parameters_ros
