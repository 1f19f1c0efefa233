// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Small recordings for tests.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../ros/message_decoder.hpp"

namespace ramscout_bringup_ros {

/// A recording in memory.
class Memory : public MessageSource {
public:
  explicit Memory(std::vector<RecordedMessage> messages) : messages_(std::move(messages)) {
    const char* const kTypes[] = {"sensor_msgs/LaserScan", "nav_msgs/Odometry",
                                  "tf2_msgs/TFMessage"};
    for (const RecordedMessage& message : messages_) {
      const auto known = std::find_if(topics_.begin(), topics_.end(), [&](const auto& topic) {
        return topic.name == message.topic;
      });
      if (known == topics_.end())
        topics_.push_back({message.topic, kTypes[message.content.index()], 1});
    }
  }
  const std::vector<ramscout_bringup::RecordedTopic>& topics() const override { return topics_; }
  void restart(const std::vector<std::string>& topics) override {
    wanted_ = topics;
    next_ = 0;
  }
  std::optional<RecordedMessage> next() override {
    while (next_ < messages_.size()) {
      const RecordedMessage& message = messages_[next_++];
      if (std::count(wanted_.begin(), wanted_.end(), message.topic) > 0) return message;
    }
    return std::nullopt;
  }

private:
  std::vector<RecordedMessage> messages_;
  std::vector<ramscout_bringup::RecordedTopic> topics_;
  std::vector<std::string> wanted_;
  std::size_t next_ = 0;
};

inline ros::Time time(double t_s) {
  return ros::Time(1000.0 + t_s);
}
inline RecordedMessage message(const std::string& topic,
                               double t_s,
                               const MessageContent& content) {
  return {topic, static_cast<std::int64_t>(time(t_s).toNSec()), content};
}

inline sensor_msgs::LaserScan scan(double t_s, const std::string& frame = "laser") {
  sensor_msgs::LaserScan scan;
  scan.header.stamp = time(t_s);
  scan.header.frame_id = frame;
  scan.angle_min = -1.0F;
  scan.angle_max = 1.0F;
  scan.angle_increment = 0.5F;
  scan.range_min = 0.1F;
  scan.range_max = 8.0F;
  scan.ranges = {1.0F, 2.0F, 3.0F, 2.0F, 1.0F};
  return scan;
}

inline nav_msgs::Odometry odometry(double t_s, double x_m, const std::string& child = "base_link") {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = time(t_s);
  odometry.header.frame_id = "odom";
  odometry.child_frame_id = child;
  odometry.pose.pose.position.x = x_m;
  odometry.pose.pose.orientation.w = 1.0;
  return odometry;
}

inline tf2_msgs::TFMessage transform(const std::string& parent,
                                     const std::string& child,
                                     double t_s,
                                     double x_m,
                                     double yaw_rad = 0.0) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.stamp = time(t_s);
  message.transforms[0].header.frame_id = parent;
  message.transforms[0].child_frame_id = child;
  message.transforms[0].transform.translation.x = x_m;
  message.transforms[0].transform.rotation.z = std::sin(0.5 * yaw_rad);
  message.transforms[0].transform.rotation.w = std::cos(0.5 * yaw_rad);
  return message;
}

/// 20 s of driving at 0.5 m/s: scans at 5 Hz, odometry at 10 Hz.
class Drive {
public:
  Drive() {
    messages.push_back(message("/tf_static", 0.0, transform("base_link", "laser", 0.0, 0.2)));
  }
  Drive& withScans() {
    for (int i = 0; i < 100; ++i) messages.push_back(message("/scan", 0.2 * i, scan(0.2 * i)));
    return *this;
  }
  Drive& withOdometry(const std::string& topic = "/odom", const std::string& child = "base_link") {
    for (int i = 0; i <= 200; ++i)
      messages.push_back(message(topic, 0.1 * i, odometry(0.1 * i, 0.05 * i, child)));
    return *this;
  }
  template <typename Content, typename Change>
  Drive& change(const Change& change) {
    for (RecordedMessage& message : messages)
      if (auto* content = std::get_if<Content>(&message.content)) change(*content);
    return *this;
  }
  std::vector<RecordedMessage> messages;
};

}  // namespace ramscout_bringup_ros
