// SPDX-License-Identifier: BSD-3-Clause
// The recordings of rosbag2's storage plugin sqlite3: tables topics and messages.
#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include <sqlite3.h>

#include "message_decoder.hpp"

namespace ramscout_bringup_ros {
namespace {

class SqliteSource : public MessageSource {
public:
  explicit SqliteSource(const std::string& path) : path_(path) {
    if (sqlite3_open_v2(path.c_str(), &database_, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK) {
      const std::string reason = sqlite3_errmsg(database_);
      sqlite3_close(database_);
      throw std::runtime_error("cannot read " + path + ": " + reason);
    }
    readTopics();
  }
  ~SqliteSource() override {
    sqlite3_finalize(query_);
    sqlite3_close(database_);
  }
  SqliteSource(const SqliteSource&) = delete;
  SqliteSource& operator=(const SqliteSource&) = delete;

  const std::vector<ramscout_bringup::RecordedTopic>& topics() const override { return topics_; }

  void restart(const std::vector<std::string>& topics) override {
    damaged_count_ = 0;
    const std::set<std::string> wanted(topics.begin(), topics.end());
    std::string ids;
    for (const auto& [id, topic] : topic_of_id_)
      if (wanted.count(topic.name) > 0) ids += (ids.empty() ? "" : ",") + std::to_string(id);
    prepare("SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN (" + ids +
            ") ORDER BY timestamp, id");
  }

  std::optional<RecordedMessage> next() override {
    while (step()) {
      const Topic& topic = topic_of_id_.at(sqlite3_column_int64(query_, 0));
      const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(query_, 2));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(query_, 2));
      try {
        return RecordedMessage{topic.name, sqlite3_column_int64(query_, 1),
                               decode(topic.type, topic.encoding, bytes, size)};
      } catch (const std::runtime_error& error) {
        ++damaged_count_;
        damage_ = error.what();
      }
    }
    return std::nullopt;
  }

  std::vector<std::string> notes() const override {
    if (damaged_count_ == 0) return {};
    return {"left out " + std::to_string(damaged_count_) + " messages: " + damage_};
  }

private:
  struct Topic {
    std::string name;
    std::string type;
    std::string encoding;
  };

  void prepare(const std::string& query) {
    sqlite3_finalize(query_);
    query_ = nullptr;
    if (sqlite3_prepare_v2(database_, query.c_str(), -1, &query_, nullptr) != SQLITE_OK)
      throw std::runtime_error("cannot read " + path_ + ": " + sqlite3_errmsg(database_));
  }

  bool step() {
    const int state = sqlite3_step(query_);
    if (state != SQLITE_ROW && state != SQLITE_DONE)
      throw std::runtime_error("cannot read on in " + path_ + ": " + sqlite3_errmsg(database_));
    return state == SQLITE_ROW;
  }

  std::string text(int column) const {
    const unsigned char* begin = sqlite3_column_text(query_, column);
    return begin == nullptr ? std::string()
                            : std::string(begin, begin + sqlite3_column_bytes(query_, column));
  }

  void readTopics() {
    prepare(
        "SELECT id, name, type, serialization_format, "
        "(SELECT COUNT(*) FROM messages WHERE topic_id = topics.id) FROM topics ORDER BY id");
    while (step()) {
      const Topic topic{text(1), ros1TypeName(text(2)), text(3)};
      topic_of_id_[sqlite3_column_int64(query_, 0)] = topic;
      topics_.push_back(
          {topic.name, topic.type, static_cast<std::size_t>(sqlite3_column_int64(query_, 4))});
    }
  }

  std::string path_;
  sqlite3* database_ = nullptr;
  sqlite3_stmt* query_ = nullptr;
  std::map<std::int64_t, Topic> topic_of_id_;
  std::vector<ramscout_bringup::RecordedTopic> topics_;
  std::size_t damaged_count_ = 0;
  std::string damage_;
};

}  // namespace

std::unique_ptr<MessageSource> openSqlite(const std::string& path) {
  return std::make_unique<SqliteSource>(path);
}

}  // namespace ramscout_bringup_ros
