// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <stdexcept>
#include <utility>

#include <ram_slam/ros/conversions.hpp>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "message_decoder.hpp"

namespace ramscout_bringup_ros {
namespace {

using ramscout_bringup::RecordedTopic;

class BagSource : public MessageSource {
public:
  explicit BagSource(const std::string& path) : path_(path) {
    try {
      bag_.open(path, rosbag::bagmode::Read);
    } catch (const rosbag::BagUnindexedException&) {
      throw std::runtime_error("the bag " + path +
                               " was not closed and has no index: run `rosbag reindex " + path +
                               "`, then try again");
    } catch (const rosbag::BagException& error) {
      throw std::runtime_error("cannot read the bag " + path + " (" + error.what() +
                               "); if the recording was cut off, run `rosbag reindex " + path +
                               "`, then try again");
    }
    rosbag::View all(bag_);
    std::map<std::string, RecordedTopic> topics;
    for (const rosbag::ConnectionInfo* connection : all.getConnections())
      topics[connection->topic] = {connection->topic, ros1TypeName(connection->datatype), 0};
    for (const rosbag::MessageInstance& message : all) ++topics[message.getTopic()].message_count;
    for (auto& [name, topic] : topics) topics_.push_back(std::move(topic));
  }

  const std::vector<RecordedTopic>& topics() const override { return topics_; }

  void restart(const std::vector<std::string>& topics) override {
    view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery(topics));
    message_ = view_->begin();
    damaged_count_ = 0;
  }

  std::optional<RecordedMessage> next() override {
    for (; message_ != view_->end(); ++message_) {
      try {
        auto message = convert(*message_);
        if (!message) continue;
        ++message_;
        return message;
      } catch (const std::exception& error) {
        ++damaged_count_;
        damage_ = error.what();
      }
    }
    return std::nullopt;
  }

  std::vector<std::string> notes() const override {
    if (damaged_count_ == 0) return {};
    return {"left out " + std::to_string(damaged_count_) + " messages: the bag " + path_ +
            " is damaged (" + damage_ + ")"};
  }

private:
  /// The type, if it is one that is read.
  static std::string typeOf(const rosbag::MessageInstance& message) {
    using namespace ros::message_traits;
    if (message.isType<sensor_msgs::LaserScan>()) return datatype<sensor_msgs::LaserScan>();
    if (message.isType<nav_msgs::Odometry>()) return datatype<nav_msgs::Odometry>();
    if (message.isType<tf2_msgs::TFMessage>()) return datatype<tf2_msgs::TFMessage>();
    if (message.isType<sensor_msgs::MultiEchoLaserScan>())
      return datatype<sensor_msgs::MultiEchoLaserScan>();
    return "";
  }

  static std::optional<RecordedMessage> convert(const rosbag::MessageInstance& message) {
    const std::string type = typeOf(message);
    if (type.empty()) return std::nullopt;
    std::vector<std::uint8_t> bytes(message.size());
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    message.write(stream);
    return RecordedMessage{message.getTopic(), ram_slam_ros::toNanoseconds(message.getTime()),
                           decode(type, "ros1", bytes.data(), bytes.size())};
  }

  std::string path_;
  rosbag::Bag bag_;
  std::vector<RecordedTopic> topics_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator message_;
  std::size_t damaged_count_ = 0;
  std::string damage_;  ///< of the newest one
};

}  // namespace

std::unique_ptr<MessageSource> openBag(const std::string& path) {
  return std::make_unique<BagSource>(path);
}

}  // namespace ramscout_bringup_ros
