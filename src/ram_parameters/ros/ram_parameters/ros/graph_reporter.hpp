// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <thread>

#include <ros/ros.h>

#include "ram_parameters/graph_watch.hpp"

namespace ram_parameters_ros {

/// Looks at master and clock once per second, from a thread of its own, and reports what is wrong:
/// one line of the log when it begins and each half minute, and /diagnostics while it lasts. Shuts
/// the node down if the master has forgotten it.
class GraphReporter {
public:
  GraphReporter();
  ~GraphReporter();
  GraphReporter(const GraphReporter&) = delete;
  GraphReporter& operator=(const GraphReporter&) = delete;

  /// Whether this has shut the node down.
  bool hasEnded() const { return has_ended_; }

private:
  void run();
  void report();
  void publish(bool is_error, const std::string& text);

  ram_parameters::GraphWatch watch_;
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  bool was_wrong_ = false;
  std::atomic<bool> has_ended_{false};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace ram_parameters_ros
