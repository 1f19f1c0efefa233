// SPDX-License-Identifier: BSD-3-Clause
#include "fast_slam_diagnostics.hpp"

#include <diagnostic_msgs/DiagnosticArray.h>

#include "node_defaults.hpp"
#include "stage_diagnostics.hpp"

namespace ram_slam_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;

template <typename Value>
void add(DiagnosticStatus& status, const char* key, const Value& value) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = std::to_string(value);
  status.values.push_back(entry);
}

}  // namespace

FastSlamDiagnostics::FastSlamDiagnostics(double silence_s) : silence_s_(silence_s) {
  publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  timer_ = node_.createWallTimer(ros::WallDuration(kDiagnosticsPeriodS),
                                 [this](const auto&) { publish(); });
}

void FastSlamDiagnostics::addFeatures(std::size_t good_count, std::size_t rejected_count) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++lists_;
  features_ += good_count;
  rejected_features_ += rejected_count;
  newest_ = ros::WallTime::now();
}

void FastSlamDiagnostics::addRejectedList() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++lists_;
  ++rejected_lists_;
}

void FastSlamDiagnostics::set(const ram_slam::EstimatorStage& stage,
                              const ram_slam::DropCounter& queue_drops,
                              const ram_slam::LossCounter& messages,
                              bool paused,
                              const std::string& problem_of_transforms) {
  const std::lock_guard<std::mutex> lock(mutex_);
  messages_ = messages;
  problem_of_transforms_ = problem_of_transforms;
  paused_ = paused;
  is_lost_ = stage.estimator().isLost();
  state_ = stage.estimator().state();
  health_ = stage.estimator().health();
  drops_ = stage.drops();
  queue_drops_ = queue_drops;
}

DiagnosticStatus FastSlamDiagnostics::status() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::uint64_t rejected = rejected_features_ + rejected_lists_;
  const std::uint64_t newly_rejected = rejected - reported_rejected_;
  const std::uint64_t newly_good = features_ - reported_good_;
  DiagnosticStatus status;
  status.name = ros::this_node::getName() + ": localisation";
  status.hardware_id = "none";
  status.level = DiagnosticStatus::OK;
  status.message = state_;
  drop_share_.update(messages_.received(), messages_.lost(), drops_.total() + queue_drops_.total());
  if (!paused_)
    reportShare(status, drop_share_.share(), messages_,
                queue_drops_.total() > 0 ? queue_drops_ : drops_);
  if (is_lost_) {
    status.level = DiagnosticStatus::ERROR;
    status.message = "lost: " + state_;
  } else if (!problem_of_transforms_.empty()) {
    status.level = DiagnosticStatus::ERROR;
    status.message = problem_of_transforms_;
  } else if (newly_rejected > 0) {
    status.level = newly_rejected > newly_good ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN;
    status.message = "features rejected";
  } else if (paused_ || newest_.isZero() || (ros::WallTime::now() - newest_).toSec() > silence_s_) {
    status.level = DiagnosticStatus::WARN;
    status.message = paused_ ? "paused" : "no features";
  }
  add(status, "lost", is_lost_ ? 1 : 0);
  for (const auto& [key, value] : health_) add(status, key.c_str(), value);
  add(status, "lists per second",
      static_cast<double>(lists_ - reported_lists_) / kDiagnosticsPeriodS);
  add(status, "features rejected", rejected_features_);
  add(status, "lists rejected", rejected_lists_);
  addDrops(status, drops_);
  addDrops(status, queue_drops_);
  reported_lists_ = lists_;
  reported_rejected_ = rejected;
  reported_good_ = features_;
  return status;
}

void FastSlamDiagnostics::publish() {
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.push_back(status());
  publisher_.publish(message);
}

}  // namespace ram_slam_ros
