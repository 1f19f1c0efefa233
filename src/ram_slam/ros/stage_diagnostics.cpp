// SPDX-License-Identifier: BSD-3-Clause
#include "stage_diagnostics.hpp"

#include <cmath>
#include <cstdio>

#include <diagnostic_msgs/DiagnosticArray.h>

#include "node_defaults.hpp"

namespace ram_slam_ros {
namespace {

constexpr double kMuchShare = 0.2;  // a scan in five is missed by no stage

std::string seconds(std::int64_t stamp_ns) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3f s", 1e-9 * static_cast<double>(stamp_ns));
  return text;
}

void addValue(diagnostic_msgs::DiagnosticStatus& status,
              const std::string& key,
              const std::string& value) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = value;
  status.values.push_back(entry);
}

}  // namespace

void addDrops(diagnostic_msgs::DiagnosticStatus& status, const ram_slam::DropCounter& drops) {
  for (const ram_slam::Drops& row : drops.all()) {
    addValue(status, "dropped: " + toText(row.reason),
             std::to_string(row.count) + ", first at " + seconds(row.first_ns) + ", last at " +
                 seconds(row.last_ns) + (row.detail.empty() ? "" : ": " + row.detail));
  }
}

void reportShare(diagnostic_msgs::DiagnosticStatus& status,
                 double share,
                 const ram_slam::LossCounter& messages,
                 const ram_slam::DropCounter& drops) {
  using diagnostic_msgs::DiagnosticStatus;
  addValue(status, "messages received", std::to_string(messages.received()));
  addValue(status, "messages lost before they arrived", std::to_string(messages.lost()));
  if (share == 0.0) return;
  const bool is_much = share > kMuchShare;
  status.level = is_much ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN;
  status.message = std::to_string(static_cast<int>(std::ceil(100.0 * share))) +
                   " % of the messages lost or dropped" +
                   (drops.total() > 0 ? ", the newest: " + toText(drops.newest().reason) : "");
  if (!is_much) return;
  const bool is_overrun =
      drops.total() == 0 || drops.newest().reason == ram_slam::DropReason::kQueueFull;
  if (is_overrun) status.message += "; slow the sensors or the playback down, or the map suffers";
  ROS_ERROR_STREAM_THROTTLE(kLogPeriodS, status.name << ": " << status.message);
}

void DropLog::log(const ram_slam::DropCounter& drops, const std::string& input) {
  if (drops.total() == logged_) return;
  const std::uint64_t count = drops.total() - logged_;
  logged_ = drops.total();
  const ram_slam::Drops& newest = drops.newest();
  ROS_WARN_STREAM_THROTTLE(
      kLogPeriodS, "Dropped " << count << (count == 1 ? " message" : " messages") << " of " << input
                              << ", the newest of " << seconds(newest.last_ns) << ": "
                              << toText(newest.reason)
                              << (newest.detail.empty() ? "" : " (" + newest.detail + ")"));
}

StageDiagnostics::StageDiagnostics(std::string stage, std::function<Report()> report)
    : stage_(std::move(stage)), report_(std::move(report)) {
  publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  timer_ = node_.createWallTimer(ros::WallDuration(kDiagnosticsPeriodS),
                                 [this](const auto&) { publish(); });
}

void StageDiagnostics::publish() {
  const Report report = report_();
  diagnostic_msgs::DiagnosticStatus status;
  status.name = ros::this_node::getName() + ": " + stage_;
  status.hardware_id = "none";
  status.level = diagnostic_msgs::DiagnosticStatus::OK;
  status.message = "no message dropped";
  drop_share_.update(report.messages.received(), report.messages.lost(), report.drops.total());
  reportShare(status, drop_share_.share(), report.messages, report.drops);
  for (const auto& [key, value] : report.values) addValue(status, key, std::to_string(value));
  addDrops(status, report.drops);
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.push_back(status);
  publisher_.publish(message);
}

}  // namespace ram_slam_ros
