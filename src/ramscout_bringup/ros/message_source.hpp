// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nav_msgs/Odometry.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include "ramscout_bringup/topic_choice.hpp"

namespace ramscout_bringup_ros {

/// A message of a recording, whatever the file's format. Of a MultiEchoLaserScan the first echo of
/// each beam is taken.
struct RecordedMessage {
  std::string topic;
  std::int64_t received_ns = 0;  ///< when it was recorded
  std::variant<sensor_msgs::LaserScan, nav_msgs::Odometry, tf2_msgs::TFMessage> content;
};

/// Reads a file of recorded ROS messages from its beginning to its end, as often as wanted.
class MessageSource {
public:
  virtual ~MessageSource() = default;

  virtual const std::vector<ramscout_bringup::RecordedTopic>& topics() const = 0;

  /// Begins again: next() then gives the messages of these topics.
  virtual void restart(const std::vector<std::string>& topics) = 0;

  /// The next message in the order of the recording; nothing at the end.
  /// \throws std::runtime_error naming the file if it cannot be read on
  virtual std::optional<RecordedMessage> next() = 0;

  /// What was left out since restart(), in a line each; empty if nothing.
  virtual std::vector<std::string> notes() const { return {}; }
};

/// Opens a ROS 1 bag. \throws std::runtime_error naming the file and what to do about it
std::unique_ptr<MessageSource> openBag(const std::string& path);
/// Opens a recording of ROS 2 in the MCAP format. \throws std::runtime_error as openBag()
std::unique_ptr<MessageSource> openMcap(const std::string& path);
/// Opens a recording of ROS 2 in a SQLite database (.db3). \throws std::runtime_error as openBag()
std::unique_ptr<MessageSource> openSqlite(const std::string& path);

}  // namespace ramscout_bringup_ros
