// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/stages/estimator_stage.hpp"

namespace ram_slam_ros {

/// What the estimator's thread and the callbacks leave for the diagnostics, which never wait for
/// the estimator. Any thread may call.
class FastSlamDiagnostics {
public:
  void addFeatures(std::size_t good_count, std::size_t rejected_count);
  void addRejectedList();
  void set(const ram_slam::EstimatorStage& stage);

  /// Health, drops and rejected features; causes if the robot is lost or features are rejected.
  NodeDiagnostics::Report report();

private:
  void addCauses(NodeDiagnostics::Report& report);

  std::mutex mutex_;
  std::uint64_t rejected_lists_ = 0;
  std::uint64_t features_ = 0;
  std::uint64_t rejected_features_ = 0;
  /// The same when there was a look at them the last time, and what came of it.
  std::uint64_t reported_features_ = 0;
  std::uint64_t reported_rejected_ = 0;
  double reported_s_ = 0.0;
  std::vector<ram_slam::Cause> rejected_cause_;

  bool is_lost_ = false;
  std::string state_ = "tracking";
  std::vector<std::pair<std::string, double>> health_;
  ram_slam::DropCounter drops_;
};

}  // namespace ram_slam_ros
