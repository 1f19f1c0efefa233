// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ramscout_bringup {

/// The place of a message in a bag.
struct BagEntry {
  std::int64_t time_ns = 0;  ///< when it was recorded
  std::uint32_t connection = 0;
  std::uint32_t chunk = 0;
  std::uint32_t offset = 0;  ///< in the uncompressed chunk
};

struct BagConnection {
  std::string topic;
  std::string type;
  std::string md5sum;  ///< of the type's definition
};

/// A ROS 1 bag of the format 2.0 (http://wiki.ros.org/Bags/Format/2.0). Each length in it is
/// checked against what contains it. The file is opened by its index; a chunk is read when one of
/// its messages is, and kept until another one is needed.
class BagFile {
public:
  /// A chunk that is damaged where the index says that it is, or in its own index, is left out.
  /// \throws std::runtime_error naming the file and what to do if its format is another one, or if
  /// the index at its end is missing or damaged
  explicit BagFile(const std::string& path);

  /// By number.
  const std::map<std::uint32_t, BagConnection>& connections() const { return connections_; }
  /// In the order of their times.
  const std::vector<BagEntry>& entries() const { return entries_; }

  /// The message's bytes, valid until the next call.
  /// \throws std::runtime_error with the place in the file and the reason if they are damaged
  std::string_view message(const BagEntry& entry);

  /// A line about what was left out; empty if nothing was.
  std::string damage() const;

private:
  /// What the records of the file are read from.
  class File {
  public:
    explicit File(const std::string& path);
    std::string_view take(std::uint64_t offset, std::uint64_t size);
    std::uint64_t size() const { return size_; }

  private:
    std::ifstream file_;
    std::uint64_t size_ = 0;
    std::uint64_t at_ = 0;
    std::string bytes_;
  };
  struct Chunk {
    std::uint64_t offset = 0;  ///< of its record in the file
    std::string compression;
    std::uint32_t size = 0;         ///< uncompressed
    std::uint64_t data_offset = 0;  ///< in the file
    std::uint32_t data_size = 0;    ///< in the file
  };
  struct ChunkInfo {
    std::uint64_t offset = 0;
    std::map<std::uint32_t, std::uint32_t> counts;  ///< of messages, by connection
  };

  void readEnd();
  void takeConnection(std::uint64_t offset);
  /// \return where the chunk and its index end
  std::uint64_t indexChunk(const ChunkInfo& info);
  void loadChunk(std::uint32_t index);

  std::string path_;
  File file_;
  std::map<std::uint32_t, BagConnection> connections_;
  std::vector<ChunkInfo> infos_;
  std::vector<Chunk> chunks_;
  std::vector<BagEntry> entries_;

  std::uint32_t loaded_ = 0;  ///< index of the chunk, if there are bytes or a reason
  std::vector<std::uint8_t> bytes_;
  std::string unreadable_;  ///< why the loaded chunk has no bytes

  std::size_t lost_messages_ = 0;
  std::string damage_;  ///< of the first chunk that was left out
};

}  // namespace ramscout_bringup
