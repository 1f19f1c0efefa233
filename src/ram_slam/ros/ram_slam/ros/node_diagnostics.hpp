// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>

#include "ram_slam/stages/causes.hpp"
#include "ram_slam/stages/drop_counter.hpp"
#include "ram_slam/stages/input_watch.hpp"
#include "ram_slam/stages/loss_counter.hpp"

namespace ram_slam_ros {

/// Logs that messages were dropped: at once, and while that goes on after five seconds more, ten,
/// twenty and so on. What a node drops while the others start is counted, not logged.
class DropLog {
public:
  DropLog();
  /// \param input  topic that the dropped messages came on
  void log(const ram_slam::DropCounter& drops, const std::string& input);

private:
  std::uint64_t logged_ = 0;
  double start_s_;
  double due_s_ = 0.0;
  double pause_s_ = 0.0;
};

/// States on /diagnostics how a node does: OK only if its inputs arrive, its transforms are there
/// and its output flows; else the cause and what to do (ram_slam::CauseFinder), which is also
/// logged once. Values: inputs with rate, age and publisher, latency, drops by reason.
///
/// Published once per second and whenever level or message change. Any thread may call.
class NodeDiagnostics {
public:
  using Values = std::vector<std::pair<std::string, double>>;
  /// What the node states now. Asked for in a callback of ROS.
  struct Report {
    ram_slam::DropCounter drops;
    Values values;
    ram_slam::LossCounter messages;
    std::vector<ram_slam::Cause> causes;      ///< that the node has found itself
    std::string state = "all inputs arrive";  ///< message if nothing is wrong
  };
  /// A transform that the node needs. An empty child is the frame of the newest scan.
  struct Transform {
    std::string parent;
    std::string parent_parameter;
    std::string child;
    std::string child_parameter;
    std::string remedy;
    ram_slam::Link link = ram_slam::Link::kTf;
  };
  class Input;

  /// \param link  what the node is part of the way from the sensors to the map
  /// \param name  of the status, after the node's
  NodeDiagnostics(ram_slam::Link link, std::string name, std::function<Report()> report);

  /// Watches an input. \param facts  link, content, argument, source, is_needed and is_rare of it
  template <typename Message>
  Input& watch(const ros::Subscriber& subscriber, ram_slam::InputFacts facts) {
    facts.type = ros::message_traits::datatype<Message>();
    return watchTopic(subscriber, std::move(facts));
  }
  /// \param buffer  outlives this
  void need(const tf2_ros::Buffer& buffer, Transform transform);
  /// The transform from the base to a sensor, whose frame is that of its messages.
  void needMount(const tf2_ros::Buffer& buffer, const std::string& base_frame);
  /// The topic that is to follow the inputs, and how much later at most.
  void setOutput(const std::string& output, double patience_s = 2.0);

  template <typename Message>
  void arrived(Input& input, const ros::MessageEvent<const Message>& event) {
    // The receipt is that of the transport: a node that is busy sees its messages later.
    arrived(input, event.getMessage()->header, event.getPublisherName(), event.getReceiptTime());
  }
  void refused(Input& input, const std::string& reason);
  /// The message that has just arrived was refused if something was dropped since then.
  /// \param total_before  of the drops, before it was handed on
  void refusedIfDropped(Input& input,
                        const ram_slam::DropCounter& drops,
                        std::uint64_t total_before);
  /// What belongs to inputs of that stamp was published.
  void answered(std::int64_t stamp_ns);

private:
  struct Needed {
    const tf2_ros::Buffer* buffer = nullptr;
    Transform transform;
    double missing_since_s = 0.0;  ///< 0: it is there
  };
  Input& watchTopic(const ros::Subscriber& subscriber, ram_slam::InputFacts facts);
  void arrived(Input& input,
               const std_msgs::Header& header,
               const std::string& publisher,
               const ros::Time& receipt);
  void update();
  /// Adds what the master knows, if an input is silent.
  void askMaster(double now_s, std::vector<ram_slam::InputFacts>& inputs);
  /// The caller holds mutex_.
  ram_slam::NodeFacts facts(double now_s, const Report& report);
  void followClock(double now_s, ram_slam::NodeFacts& facts);
  diagnostic_msgs::DiagnosticStatus toStatus(double now_s,
                                             const std::vector<ram_slam::Cause>& causes,
                                             const Report& report);
  void addShare(const Report& report, std::vector<ram_slam::Cause>& causes);
  void log(const std::vector<ram_slam::Cause>& causes, double now_s);

  ram_slam::Link link_;
  std::string name_;
  std::function<Report()> report_;
  std::mutex mutex_;  ///< of the members up to the next blank line
  std::list<Input> inputs_;
  std::vector<Needed> transforms_;
  std::string output_;
  double output_patience_s_ = 0.0;
  std::string newest_frame_;
  ram_slam::LatencyWatch latency_;
  double output_s_ = -ram_slam::kNever_s;

  double start_s_;
  double published_s_ = 0.0;
  double asked_s_ = 0.0;
  std::vector<ram_slam::InputFacts> answers_;  ///< of the master, by input
  ros::Time clock_;                            ///< when it was looked at the last time
  double clock_seen_s_ = 0.0;
  double clock_moved_s_ = 0.0;
  double clock_speed_ = 1.0;
  ram_slam::CauseLog cause_log_;
  ram_slam::DropShare drop_share_;
  std::vector<ram_slam::Cause> share_cause_;  ///< none, or that of the last second
  diagnostic_msgs::DiagnosticStatus status_;  ///< the last one
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::WallTimer timer_;
};

/// One input that is watched.
class NodeDiagnostics::Input {
  friend class NodeDiagnostics;
  ram_slam::InputFacts facts_;
  ram_slam::InputWatch watch_;
};

/// Adds a cause if the disk of a folder is nearly full. \param folder  a leading ~ is the home
/// folder
void addDiskCause(const std::string& folder, std::vector<ram_slam::Cause>& causes);

/// What the inputs that several nodes have are.
ram_slam::InputFacts scanInput();
ram_slam::InputFacts odometryInput();
/// Odometry that may be refined: on `odom`, remapped to `laser_odom`.
ram_slam::InputFacts refinedOdometryInput();
ram_slam::InputFacts featuresInput();

}  // namespace ram_slam_ros
