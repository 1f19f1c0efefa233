// SPDX-License-Identifier: BSD-3-Clause
#include "fast_slam_diagnostics.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {

using ram_slam::Link;
using ram_slam::Severity;

void FastSlamDiagnostics::addFeatures(std::size_t good_count, std::size_t rejected_count) {
  const std::lock_guard<std::mutex> lock(mutex_);
  features_ += good_count;
  rejected_features_ += rejected_count;
}

void FastSlamDiagnostics::addRejectedList() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++rejected_lists_;
}

void FastSlamDiagnostics::set(const ram_slam::EstimatorStage& stage) {
  const std::lock_guard<std::mutex> lock(mutex_);
  is_lost_ = stage.estimator().isLost();
  state_ = stage.estimator().state();
  health_ = stage.estimator().health();
  drops_ = stage.drops();
}

NodeDiagnostics::Report FastSlamDiagnostics::report() {
  const std::lock_guard<std::mutex> lock(mutex_);
  NodeDiagnostics::Report report;
  report.state = state_;
  report.drops = drops_;
  report.values = {{"lost", is_lost_ ? 1.0 : 0.0}};
  report.values.insert(report.values.end(), health_.begin(), health_.end());
  report.values.emplace_back("features rejected", static_cast<double>(rejected_features_));
  report.values.emplace_back("lists rejected", static_cast<double>(rejected_lists_));
  addCauses(report);
  return report;
}

void FastSlamDiagnostics::addCauses(NodeDiagnostics::Report& report) {
  if (is_lost_) {
    report.causes.push_back({Link::kPose, Severity::kError, "lost",
                             "lost: " + state_ +
                                 "; drive on slowly where the robot has been before, or set its "
                                 "pose (initialpose)"});
  }
  const std::uint64_t rejected = rejected_features_ + rejected_lists_;
  const double now_s = ros::SteadyTime::now().toSec();
  if (now_s >= reported_s_ + kDiagnosticsPeriodS) {
    const std::uint64_t newly_rejected = rejected - reported_rejected_;
    const std::uint64_t newly_good = features_ - reported_features_;
    rejected_cause_.clear();
    if (newly_rejected > 0) {
      rejected_cause_.push_back(
          {Link::kFeatures, newly_rejected > newly_good ? Severity::kError : Severity::kWarning,
           "features rejected",
           "features rejected: positions, covariances, stamps or frames are unusable"});
    }
    reported_s_ = now_s;
    reported_rejected_ = rejected;
    reported_features_ = features_;
  }
  report.causes.insert(report.causes.end(), rejected_cause_.begin(), rejected_cause_.end());
}

}  // namespace ram_slam_ros
