// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/node_diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <diagnostic_msgs/DiagnosticArray.h>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/io/free_space.hpp"
#include "ram_slam/ros/conversions.hpp"

#include "graph_facts.hpp"
#include "node_defaults.hpp"

namespace ram_slam_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using ram_slam::Cause;
using ram_slam::Severity;

double wallNow_s() {
  return ros::SteadyTime::now().toSec();
}

std::string rounded(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof(text), "%.3f %s", value, unit);
  return text;
}

void addValue(DiagnosticStatus& status, const std::string& key, const std::string& value) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = value;
  status.values.push_back(entry);
}

/// Value of what was dropped for a reason: "3, first at 12.300 s, last at 14.100 s: detail".
void addDrops(DiagnosticStatus& status, const ram_slam::DropCounter& drops) {
  for (const ram_slam::Drops& row : drops.all()) {
    const auto seconds = [](std::int64_t stamp_ns) {
      return rounded(1e-9 * static_cast<double>(stamp_ns), "s");
    };
    addValue(status, "dropped: " + toText(row.reason),
             std::to_string(row.count) + ", first at " + seconds(row.first_ns) + ", last at " +
                 seconds(row.last_ns) + (row.detail.empty() ? "" : ": " + row.detail));
  }
}

}  // namespace

DropLog::DropLog() : start_s_(wallNow_s()) {}

void DropLog::log(const ram_slam::DropCounter& drops, const std::string& input) {
  if (drops.total() == logged_) return;
  const double now_s = wallNow_s();
  if (now_s < start_s_ + kStartingS) logged_ = drops.total();
  if (now_s < std::max(due_s_, start_s_ + kStartingS)) return;
  pause_s_ = now_s > due_s_ + pause_s_ ? kLogPeriodS : 2.0 * pause_s_;
  due_s_ = now_s + pause_s_;
  const std::uint64_t count = drops.total() - logged_;
  logged_ = drops.total();
  const ram_slam::Drops& newest = drops.newest();
  ROS_WARN_STREAM("Dropped " << count << (count == 1 ? " message" : " messages") << " of " << input
                             << ", the newest of "
                             << rounded(1e-9 * static_cast<double>(newest.last_ns), "s") << ": "
                             << toText(newest.reason)
                             << (newest.detail.empty() ? "" : " (" + newest.detail + ")"));
}

void addDiskCause(const std::string& folder, std::vector<Cause>& causes) {
  std::string problem = ram_slam::freeSpaceProblem(ram_slam::expandHome(folder));
  if (problem.empty()) return;
  causes.push_back({ram_slam::Link::kMap, Severity::kError, "disk full", std::move(problem)});
}

ram_slam::InputFacts scanInput() {
  ram_slam::InputFacts input;
  input.link = ram_slam::Link::kScan;
  input.content = "scans";
  input.argument = "scan";
  input.source = "the driver of the lidar";
  return input;
}

ram_slam::InputFacts odometryInput() {
  ram_slam::InputFacts input;
  input.link = ram_slam::Link::kOdometry;
  input.content = "odometry";
  input.argument = "odom";
  input.source = "the driver of the wheels";
  return input;
}

ram_slam::InputFacts refinedOdometryInput() {
  ram_slam::InputFacts input = odometryInput();
  input.source = "laser_odometry (features.launch), or the driver of the wheels";
  return input;
}

ram_slam::InputFacts featuresInput() {
  ram_slam::InputFacts input;
  input.link = ram_slam::Link::kFeatures;
  input.content = "features";
  input.argument = "features";
  input.source = "a detector (features.launch)";
  return input;
}

NodeDiagnostics::NodeDiagnostics(ram_slam::Link link,
                                 std::string name,
                                 std::function<Report()> report)
    : link_(link), name_(std::move(name)), report_(std::move(report)), start_s_(wallNow_s()) {
  clock_seen_s_ = clock_moved_s_ = start_s_;
  publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10);
  timer_ = node_.createWallTimer(ros::WallDuration(kDiagnosticsCheckS),
                                 [this](const auto&) { update(); });
}

NodeDiagnostics::Input& NodeDiagnostics::watchTopic(const ros::Subscriber& subscriber,
                                                    ram_slam::InputFacts facts) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Input& input = inputs_.emplace_back();
  input.facts_ = std::move(facts);
  input.facts_.topic = subscriber.getTopic();
  return input;
}

void NodeDiagnostics::need(const tf2_ros::Buffer& buffer, Transform transform) {
  const std::lock_guard<std::mutex> lock(mutex_);
  transforms_.push_back({&buffer, std::move(transform)});
}

void NodeDiagnostics::needMount(const tf2_ros::Buffer& buffer, const std::string& base_frame) {
  need(buffer,
       {base_frame, "base_frame", "", "",
        "start robot_state_publisher with the robot's URDF, or a static_transform_publisher "
        "from the base to the laser"});
}

void NodeDiagnostics::setOutput(const std::string& output, double patience_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  output_patience_s_ = patience_s;
  output_ = output;
}

void NodeDiagnostics::arrived(Input& input,
                              const std_msgs::Header& header,
                              const std::string& publisher,
                              const ros::Time& receipt) {
  const double now_s = wallNow_s();
  const double stamp_age_s = (receipt - header.stamp).toSec();
  const std::lock_guard<std::mutex> lock(mutex_);
  input.watch_.arrived(publisher, stamp_age_s, now_s);
  if (input.facts_.link == ram_slam::Link::kScan) newest_frame_ = header.frame_id;
  latency_.arrived(toNanoseconds(header.stamp), now_s);
}

void NodeDiagnostics::refused(Input& input, const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  input.watch_.refused(reason, wallNow_s());
}

void NodeDiagnostics::refusedIfDropped(Input& input,
                                       const ram_slam::DropCounter& drops,
                                       std::uint64_t total_before) {
  if (drops.total() == total_before) return;
  const ram_slam::Drops& newest = drops.newest();
  refused(input, toText(newest.reason) + (newest.detail.empty() ? "" : ", " + newest.detail));
}

void NodeDiagnostics::answered(std::int64_t stamp_ns) {
  const std::lock_guard<std::mutex> lock(mutex_);
  output_s_ = wallNow_s();
  latency_.answered(stamp_ns, output_s_);
}

void NodeDiagnostics::update() {
  const Report report = report_();
  const double now_s = wallNow_s();
  ram_slam::NodeFacts seen;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    seen = facts(now_s, report);
  }
  askMaster(now_s, seen.inputs);
  std::vector<Cause> causes = ram_slam::CauseFinder::find(seen);
  const bool is_due = now_s >= published_s_ + kDiagnosticsPeriodS;
  if (is_due) addShare(report, share_cause_);
  log(causes.empty() ? share_cause_ : causes, now_s - start_s_);
  causes.insert(causes.end(), share_cause_.begin(), share_cause_.end());
  DiagnosticStatus status = toStatus(now_s, causes, report);
  if (!is_due && status.level == status_.level && status.message == status_.message) return;
  if (is_due) published_s_ = now_s;
  status_ = status;
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.push_back(std::move(status));
  publisher_.publish(message);
}

void NodeDiagnostics::askMaster(double now_s, std::vector<ram_slam::InputFacts>& inputs) {
  const bool is_wanted =
      std::any_of(inputs.begin(), inputs.end(), [](const ram_slam::InputFacts& input) {
        return input.is_rare ? input.age_s == ram_slam::kNever_s
                             : input.age_s > kLongestUsualIntervalS;
      });
  if (!is_wanted) return;
  if (now_s >= asked_s_ + kMasterPeriodS) {
    asked_s_ = now_s;
    answers_ = inputs;
    lookAtMaster(answers_);
  }
  for (std::size_t i = 0; i < std::min(inputs.size(), answers_.size()); ++i) {
    inputs[i].publishers = answers_[i].publishers;
    inputs[i].dead = answers_[i].dead;
    inputs[i].published_type = answers_[i].published_type;
    inputs[i].elsewhere = answers_[i].elsewhere;
  }
}

ram_slam::NodeFacts NodeDiagnostics::facts(double now_s, const Report& report) {
  ram_slam::NodeFacts facts;
  facts.link = link_;
  facts.running_s = now_s - start_s_;
  facts.own = report.causes;
  facts.output = output_;
  facts.output_patience_s = output_patience_s_;
  facts.output_age_s = now_s - output_s_;
  followClock(now_s, facts);
  for (const Input& input : inputs_) {
    ram_slam::InputFacts& of_input = facts.inputs.emplace_back(input.facts_);
    input.watch_.report(now_s, of_input);
  }
  for (Needed& needed : transforms_) {
    const Transform& wanted = needed.transform;
    ram_slam::TransformFacts transform;
    transform.link = wanted.link;
    transform.parent = wanted.parent;
    transform.child = wanted.child.empty() ? newest_frame_ : wanted.child;
    transform.parent_parameter = wanted.parent_parameter;
    transform.child_parameter = wanted.child_parameter;
    transform.remedy = wanted.remedy;
    if (transform.child.empty() || !facts.has_clock) continue;
    lookAtTf(*needed.buffer, transform);
    if (transform.missing_s == 0.0) {
      needed.missing_since_s = 0.0;
    } else {
      if (needed.missing_since_s == 0.0) needed.missing_since_s = now_s;
      transform.missing_s = now_s - needed.missing_since_s;
    }
    facts.transforms.push_back(std::move(transform));
  }
  return facts;
}

void NodeDiagnostics::followClock(double now_s, ram_slam::NodeFacts& facts) {
  facts.is_simulated_time = ros::Time::isSimTime();
  const ros::Time clock = ros::Time::now();
  facts.has_clock = !clock.isZero();
  if (clock != clock_) {
    if (now_s > clock_seen_s_ && !clock_.isZero() && clock > clock_)
      clock_speed_ = (clock - clock_).toSec() / (now_s - clock_seen_s_);
    clock_moved_s_ = now_s;
  }
  clock_ = clock;
  clock_seen_s_ = now_s;
  facts.clock_standing_s = now_s - clock_moved_s_;
  facts.clock_speed = clock_speed_;
}

DiagnosticStatus NodeDiagnostics::toStatus(double now_s,
                                           const std::vector<Cause>& causes,
                                           const Report& report) {
  DiagnosticStatus status;
  status.name = ros::this_node::getName() + ": " + name_;
  status.hardware_id = "none";
  status.level =
      static_cast<std::uint8_t>(causes.empty() ? Severity::kOk : causes.front().severity);
  status.message = causes.empty() ? report.state : causes.front().text;
  addValue(status, "link", toText(link_));
  for (const Cause& cause : causes) {
    const std::string kind = cause.severity == Severity::kError ? "cause: " : "warning: ";
    addValue(status, kind + toText(cause.link) + ": " + cause.name, cause.text);
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const Input& input : inputs_) {
      ram_slam::InputFacts facts;
      input.watch_.report(now_s, facts);
      addValue(status, "input: " + toText(input.facts_.link) + ": " + input.facts_.topic,
               facts.age_s == ram_slam::kNever_s
                   ? "nothing yet"
                   : rounded(input.watch_.rate_hz(now_s), "Hz") + ", newest " +
                         rounded(facts.age_s, "s") + " ago from " + facts.newest_publisher);
    }
    addValue(status, "latency p50", rounded(latency_.percentile_s(0.5), "s"));
    addValue(status, "latency p99", rounded(latency_.percentile_s(0.99), "s"));
  }
  addValue(status, "messages received", std::to_string(report.messages.received()));
  addValue(status, "messages lost before they arrived", std::to_string(report.messages.lost()));
  for (const auto& [key, value] : report.values) addValue(status, key, std::to_string(value));
  addDrops(status, report.drops);
  return status;
}

void NodeDiagnostics::addShare(const Report& report, std::vector<Cause>& causes) {
  drop_share_.update(report.messages.received(), report.messages.lost(), report.drops.total());
  causes.clear();
  const double share = drop_share_.share();
  if (share == 0.0) return;
  const bool is_much = share > kMuchShare;
  Cause cause{link_, is_much ? Severity::kError : Severity::kWarning, "messages lost",
              std::to_string(static_cast<int>(std::ceil(100.0 * share))) +
                  " % of the messages lost or dropped"};
  const bool is_overrun =
      report.drops.total() == 0 || report.drops.newest().reason == ram_slam::DropReason::kQueueFull;
  if (report.drops.total() > 0) {
    cause.text += ", the newest: " + toText(report.drops.newest().reason);
    if (!report.drops.newest().detail.empty())
      cause.text += " (" + report.drops.newest().detail + ")";
  }
  if (is_much && is_overrun)
    cause.text += "; slow the sensors or the playback down, or the map suffers";
  causes.push_back(std::move(cause));
}

void NodeDiagnostics::log(const std::vector<Cause>& causes, double now_s) {
  for (const Cause& cause : cause_log_.update(causes, now_s)) {
    if (cause.severity == Severity::kError) {
      ROS_ERROR_STREAM(cause.text);
    } else {
      ROS_WARN_STREAM(cause.text);
    }
  }
}

}  // namespace ram_slam_ros
