// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "ramscout_bringup/bag_file.hpp"

#include "message_decoder.hpp"

namespace ramscout_bringup_ros {
namespace {

using ramscout_bringup::BagConnection;
using ramscout_bringup::BagEntry;
using ramscout_bringup::RecordedTopic;

class BagSource : public MessageSource {
public:
  explicit BagSource(const std::string& path) : path_(path), bag_(path) {
    std::map<std::string, RecordedTopic> topics;
    for (const auto& [number, connection] : bag_.connections())
      topics[connection.topic] = {connection.topic, ros1TypeName(connection.type), 0};
    for (const BagEntry& entry : bag_.entries()) ++topics[connectionOf(entry).topic].message_count;
    for (auto& [name, topic] : topics) topics_.push_back(std::move(topic));
  }

  const std::vector<RecordedTopic>& topics() const override { return topics_; }

  void restart(const std::vector<std::string>& topics) override {
    wanted_.clear();
    for (const auto& [number, connection] : bag_.connections()) {
      if (std::count(topics.begin(), topics.end(), connection.topic) > 0)
        wanted_[number] = typeOf(connection);
    }
    next_ = 0;
    damaged_count_ = 0;
  }

  std::optional<RecordedMessage> next() override {
    while (next_ < bag_.entries().size()) {
      const BagEntry& entry = bag_.entries()[next_++];
      const auto type = wanted_.find(entry.connection);
      if (type == wanted_.end() || type->second.empty()) continue;
      try {
        const std::string_view bytes = bag_.message(entry);
        return RecordedMessage{
            connectionOf(entry).topic, entry.time_ns,
            decode(type->second, "ros1", reinterpret_cast<const std::uint8_t*>(bytes.data()),
                   bytes.size())};
      } catch (const std::exception& error) {
        ++damaged_count_;
        damage_ = error.what();
      }
    }
    return std::nullopt;
  }

  std::vector<std::string> notes() const override {
    std::vector<std::string> notes;
    if (damaged_count_ > 0)
      notes.push_back("left out " + std::to_string(damaged_count_) + " messages: the bag " + path_ +
                      " is damaged (" + damage_ + ")");
    if (!bag_.damage().empty()) notes.push_back(bag_.damage());
    return notes;
  }

private:
  const BagConnection& connectionOf(const BagEntry& entry) const {
    return bag_.connections().at(entry.connection);
  }

  /// The type, if it is one that is read and of this definition.
  static std::string typeOf(const BagConnection& connection) {
    using namespace ros::message_traits;
    const auto is = [&connection](const char* sum) {
      return connection.md5sum == sum || connection.md5sum == "*";
    };
    if (is(md5sum<sensor_msgs::LaserScan>())) return datatype<sensor_msgs::LaserScan>();
    if (is(md5sum<nav_msgs::Odometry>())) return datatype<nav_msgs::Odometry>();
    if (is(md5sum<tf2_msgs::TFMessage>())) return datatype<tf2_msgs::TFMessage>();
    if (is(md5sum<sensor_msgs::MultiEchoLaserScan>()))
      return datatype<sensor_msgs::MultiEchoLaserScan>();
    return "";
  }

  std::string path_;
  ramscout_bringup::BagFile bag_;
  std::vector<RecordedTopic> topics_;
  std::map<std::uint32_t, std::string> wanted_;  ///< type of the messages, by connection
  std::size_t next_ = 0;                         ///< index of an entry
  std::size_t damaged_count_ = 0;
  std::string damage_;  ///< of the newest one
};

}  // namespace

std::unique_ptr<MessageSource> openBag(const std::string& path) {
  return std::make_unique<BagSource>(path);
}

}  // namespace ramscout_bringup_ros
