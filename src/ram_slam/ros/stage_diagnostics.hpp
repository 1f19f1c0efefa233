// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>

#include "ram_slam/stages/drop_counter.hpp"
#include "ram_slam/stages/loss_counter.hpp"

namespace ram_slam_ros {

/// Key of what was dropped for a reason, and its value: "3, first at 12.300 s, last at 14.100 s:
/// detail".
void addDrops(diagnostic_msgs::DiagnosticStatus& status, const ram_slam::DropCounter& drops);

/// Sets level and message if a share of the messages was not used, and logs one line if it is more
/// than a fifth.
void reportShare(diagnostic_msgs::DiagnosticStatus& status,
                 double share,
                 const ram_slam::LossCounter& messages,
                 const ram_slam::DropCounter& drops);

/// One log line for each message that a stage drops, at most one per five seconds.
class DropLog {
public:
  /// \param input  topic that the dropped messages came on
  void log(const ram_slam::DropCounter& drops, const std::string& input);

private:
  std::uint64_t logged_ = 0;
};

/// What a stage drops, by reason, and what was lost before it arrived, once per second on
/// /diagnostics: WARN while there is any, ERROR if it is more than a fifth of the messages.
class StageDiagnostics {
public:
  using Values = std::vector<std::pair<std::string, double>>;
  /// What the stage states now. Called from a callback of ROS.
  struct Report {
    ram_slam::DropCounter drops;
    Values values;
    ram_slam::LossCounter messages;
  };

  /// \param stage  name after the node's
  StageDiagnostics(std::string stage, std::function<Report()> report);

private:
  void publish();

  std::string stage_;
  std::function<Report()> report_;
  ram_slam::DropShare drop_share_;
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::WallTimer timer_;
};

}  // namespace ram_slam_ros
