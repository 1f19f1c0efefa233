// SPDX-License-Identifier: BSD-3-Clause
#include "fast_slam_diagnostics.hpp"

#include <diagnostic_msgs/DiagnosticArray.h>

namespace ram_slam_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kPeriodS = 1.0;
constexpr double kSilenceS = 2.0;

template <typename Value>
void add(DiagnosticStatus& status, const char* key, const Value& value) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = std::to_string(value);
  status.values.push_back(entry);
}

}  // namespace

std::string toText(ram_slam::LostReason reason) {
  switch (reason) {
    case ram_slam::LostReason::kTracking:
      return "tracking";
    case ram_slam::LostReason::kDiscontinuity:
      return "recent readings show two different places";
    case ram_slam::LostReason::kMapContradicts:
      return "the readings contradict the map";
    case ram_slam::LostReason::kRequested:
      return "a global localisation was requested";
  }
  return "";
}

FastSlamDiagnostics::FastSlamDiagnostics() {
  publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  timer_ = node_.createWallTimer(ros::WallDuration(kPeriodS), [this](const auto&) { publish(); });
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

void FastSlamDiagnostics::set(const ram_slam::Tracker& slam, bool paused) {
  const std::lock_guard<std::mutex> lock(mutex_);
  paused_ = paused;
  reason_ = slam.reason();
  agreement_ = slam.agreement();
  quality_ = slam.filter().quality();
  landmarks_ = slam.filter().registry().records().size();
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
  status.message = toText(reason_);
  if (reason_ != ram_slam::LostReason::kTracking) {
    status.level = DiagnosticStatus::ERROR;
    status.message = "lost: " + toText(reason_);
  } else if (newly_rejected > 0) {
    status.level = newly_rejected > newly_good ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN;
    status.message = "features rejected";
  } else if (paused_ || newest_.isZero() || (ros::WallTime::now() - newest_).toSec() > kSilenceS) {
    status.level = DiagnosticStatus::WARN;
    status.message = paused_ ? "paused" : "no features";
  }
  add(status, "lost", reason_ == ram_slam::LostReason::kTracking ? 0 : 1);
  add(status, "quality: landmarks found of those expected", agreement_.quality());
  add(status, "landmarks expected", agreement_.expected_count);
  add(status, "landmarks found", agreement_.found_count);
  add(status, "places with features unknown to the map", agreement_.unexplained_count);
  add(status, "features matched of late", quality_.matched_fraction);
  add(status, "normalised innovation", quality_.normalised_innovation);
  add(status, "effective particles", quality_.effective_fraction);
  add(status, "landmarks", landmarks_);
  add(status, "lists per second", static_cast<double>(lists_ - reported_lists_) / kPeriodS);
  add(status, "features rejected", rejected_features_);
  add(status, "lists rejected", rejected_lists_);
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
