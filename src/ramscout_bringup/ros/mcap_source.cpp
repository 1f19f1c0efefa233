// SPDX-License-Identifier: BSD-3-Clause
// MCAP, version 0 (https://mcap.dev/spec): records of one byte of type, eight bytes of length and
// content; messages stand alone or in compressed chunks. The file is read from its beginning to its
// end without its index, so that a recording that was cut off can be read as far as it goes.
#include <algorithm>
#include <cstring>
#include <deque>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <boost/crc.hpp>

#include "ramscout_bringup/compression.hpp"

#include "message_decoder.hpp"

namespace ramscout_bringup_ros {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kMagicSize = 8;

enum Opcode : std::uint8_t { kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6, kDataEnd = 15 };

class Reader {
public:
  Reader(const std::uint8_t* begin, std::size_t size) : at_(begin), left_(size) {}

  template <typename Number>
  Number number() {
    Number value{};
    std::memcpy(&value, take(sizeof(value)), sizeof(value));
    return value;
  }
  std::string text() {
    const auto size = number<std::uint32_t>();
    const std::uint8_t* begin = take(size);
    return {begin, begin + size};
  }
  const std::uint8_t* take(std::uint64_t size) {
    if (size > left_) throw std::runtime_error("a record is shorter than it states");
    const std::uint8_t* begin = at_;
    at_ += size;
    left_ -= size;
    return begin;
  }
  std::size_t left() const { return left_; }

private:
  const std::uint8_t* at_;
  std::size_t left_;
};

Bytes chunkRecords(Reader chunk) {
  chunk.take(16);  // times of the first and the last message
  const auto size = chunk.number<std::uint64_t>();
  const auto checksum = chunk.number<std::uint32_t>();
  const std::string compression = chunk.text();
  const auto compressed_size = chunk.number<std::uint64_t>();
  const std::uint8_t* begin = chunk.take(compressed_size);
  Bytes records = ramscout_bringup::uncompressed(
      compression, {reinterpret_cast<const char*>(begin), compressed_size}, size);
  boost::crc_32_type sum;
  sum.process_bytes(records.data(), records.size());
  if (checksum != 0 && sum.checksum() != checksum)
    throw std::runtime_error("a chunk does not have its checksum");
  return records;
}

class McapSource : public MessageSource {
public:
  explicit McapSource(const std::string& path) : path_(path) {
    restart({});
    is_counting_ = true;
    while (readRecord()) messages_.clear();
    is_counting_ = false;
    if (channels_.empty()) throw std::runtime_error(path_ + " holds no channel");
    std::map<std::string, ramscout_bringup::RecordedTopic> topics;
    for (const auto& [id, channel] : channels_) {
      auto& topic = topics[channel.topic];
      topic.name = channel.topic;
      topic.type = channel.type;
      topic.message_count += channel.count;
    }
    for (auto& [name, topic] : topics) topics_.push_back(std::move(topic));
  }

  const std::vector<ramscout_bringup::RecordedTopic>& topics() const override { return topics_; }

  void restart(const std::vector<std::string>& topics) override {
    wanted_ = {topics.begin(), topics.end()};
    messages_.clear();
    cut_off_.clear();
    damaged_count_ = 0;
    file_ = std::ifstream(path_, std::ios::binary | std::ios::ate);
    size_ = static_cast<std::uint64_t>(file_.tellg());
    file_.seekg(kMagicSize);
  }

  std::optional<RecordedMessage> next() override {
    while (messages_.empty())
      if (!readRecord()) return std::nullopt;
    RecordedMessage message = std::move(messages_.front());
    messages_.pop_front();
    return message;
  }

  std::vector<std::string> notes() const override {
    std::vector<std::string> notes;
    if (!cut_off_.empty())
      notes.push_back("the recording ends early and was read as far as it goes: " + cut_off_);
    if (damaged_count_ > 0)
      notes.push_back("left out " + std::to_string(damaged_count_) + " messages: " + damage_);
    return notes;
  }

private:
  struct Channel {
    std::string topic;
    std::string type;
    std::string encoding;
    std::size_t count = 0;
  };

  /// Reads the next record of the file. \return false at the end
  bool readRecord() {
    std::uint8_t opcode = 0;
    std::uint64_t length = 0;
    file_.read(reinterpret_cast<char*>(&opcode), sizeof(opcode));
    file_.read(reinterpret_cast<char*>(&length), sizeof(length));
    if (!file_) return endsEarly("there is no end of the data");
    if (opcode == kDataEnd) return false;
    const auto at = static_cast<std::uint64_t>(file_.tellg());
    if (length > size_ - at) return endsEarly("its last record is cut");
    if (opcode != kSchema && opcode != kChannel && opcode != kMessage && opcode != kChunk) {
      file_.seekg(static_cast<std::streamoff>(length), std::ios::cur);
      return true;
    }
    if (length > ramscout_bringup::kMaxChunkSize + (1U << 20U))
      return endsEarly("it has a record of nonsensical length");
    Bytes content(length);
    file_.read(reinterpret_cast<char*>(content.data()), static_cast<std::streamsize>(length));
    try {
      if (opcode == kChunk) {
        takeChunk(chunkRecords({content.data(), content.size()}));
      } else {
        take(opcode, {content.data(), content.size()});
      }
    } catch (const std::runtime_error& error) {
      return endsEarly(error.what());
    }
    return true;
  }

  bool endsEarly(const std::string& reason) {
    cut_off_ = reason;
    return false;
  }

  void takeChunk(const Bytes& records) {
    Reader reader(records.data(), records.size());
    while (reader.left() > 0) {
      const auto opcode = reader.number<std::uint8_t>();
      const auto length = reader.number<std::uint64_t>();
      take(opcode, {reader.take(length), length});
    }
  }

  void take(std::uint8_t opcode, Reader record) {
    if (opcode == kSchema) {
      const auto id = record.number<std::uint16_t>();
      schemas_[id] = ros1TypeName(record.text());
    } else if (opcode == kChannel) {
      const auto id = record.number<std::uint16_t>();
      Channel& channel = channels_[id];
      const auto schema = record.number<std::uint16_t>();
      channel.topic = record.text();
      channel.type = schemas_[schema];
      channel.encoding = record.text();
    } else if (opcode == kMessage) {
      takeMessage(record);
    }
  }

  void takeMessage(Reader record) {
    const auto channel = channels_.find(record.number<std::uint16_t>());
    if (channel == channels_.end()) throw std::runtime_error("a message without a channel");
    if (is_counting_) ++channel->second.count;
    if (wanted_.count(channel->second.topic) == 0) return;
    record.take(4);  // sequence number
    const auto log_time = record.number<std::uint64_t>();
    record.take(8);  // time of publication
    const std::size_t size = record.left();
    try {
      messages_.push_back(
          {channel->second.topic, static_cast<std::int64_t>(log_time),
           decode(channel->second.type, channel->second.encoding, record.take(size), size)});
    } catch (const std::runtime_error& error) {
      ++damaged_count_;
      damage_ = error.what();
    }
  }

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<ramscout_bringup::RecordedTopic> topics_;
  std::set<std::string> wanted_;
  std::deque<RecordedMessage> messages_;  ///< of the newest chunk
  bool is_counting_ = false;
  std::string cut_off_;
  std::size_t damaged_count_ = 0;
  std::string damage_;
};

}  // namespace

std::unique_ptr<MessageSource> openMcap(const std::string& path) {
  return std::make_unique<McapSource>(path);
}

}  // namespace ramscout_bringup_ros
