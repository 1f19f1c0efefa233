// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ram_slam/stages/causes.hpp"

namespace ramscout_bringup {

/// What a node has reported about itself on /diagnostics.
struct NodeReport {
  std::string node;                             ///< "/fast_slam"
  std::string name;                             ///< of the status, after the node's: "localisation"
  ram_slam::Link link = ram_slam::Link::kScan;  ///< that the node is
  ram_slam::Severity severity = ram_slam::Severity::kOk;
  std::string message;
  std::vector<ram_slam::Cause> causes;
  /// Inputs: "/scan: 40 Hz, newest 0.01 s ago from /lidar".
  std::vector<std::pair<ram_slam::Link, std::string>> inputs;
};

/// A report from one status of /diagnostics: its name, level and message, and its values as keys
/// with texts. \return false if it is not from a node of this system
bool toNodeReport(const std::string& name,
                  int level,
                  const std::string& message,
                  const std::vector<std::pair<std::string, std::string>>& values,
                  NodeReport& report);

/// A node that the master knows and that reports nothing.
struct SilentNode {
  std::string node;
  ram_slam::Link link = ram_slam::Link::kScan;
};

/// How one link of the way from the clock to the map does.
struct LinkState {
  ram_slam::Link link = ram_slam::Link::kScan;
  bool is_ok = true;
  std::string text;  ///< what is there, or what is wrong and what to do
};

/// Each link of the way, in its order, judged by what the nodes have reported themselves.
std::vector<LinkState> checkChain(const std::vector<NodeReport>& reports,
                                  const std::vector<SilentNode>& silent);

}  // namespace ramscout_bringup
