// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/bag_file.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "ramscout_bringup/compression.hpp"

namespace ramscout_bringup {
namespace {

enum Operation : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

using Fields = std::map<std::string, std::string>;

template <typename Number>
Number numberAt(std::string_view bytes, std::uint64_t offset) {
  if (bytes.size() < sizeof(Number) || offset > bytes.size() - sizeof(Number))
    throw std::runtime_error("a record is shorter than it states");
  Number number{};
  std::memcpy(&number, bytes.data() + offset, sizeof(number));
  return number;
}

/// `length name=value`, repeated.
Fields toFields(std::string_view header) {
  Fields fields;
  while (!header.empty()) {
    const auto length = numberAt<std::uint32_t>(header, 0);
    header.remove_prefix(sizeof(length));
    const std::string_view field = header.substr(0, length);
    const std::size_t separator = field.find('=');
    if (length > header.size() || separator == std::string_view::npos)
      throw std::runtime_error("a field of a record's header is damaged");
    fields.emplace(field.substr(0, separator), field.substr(separator + 1));
    header.remove_prefix(length);
  }
  return fields;
}

struct Record {
  Fields fields;
  std::uint64_t data_offset = 0;
  std::uint32_t data_size = 0;

  std::uint64_t end() const { return data_offset + data_size; }
  const std::string& text(const std::string& name) const {
    const auto field = fields.find(name);
    if (field == fields.end()) throw std::runtime_error("a record lacks its field '" + name + "'");
    return field->second;
  }
  template <typename Number>
  Number number(const std::string& name) const {
    const std::string& bytes = text(name);
    if (bytes.size() != sizeof(Number))
      throw std::runtime_error("the field '" + name + "' of a record is damaged");
    return numberAt<Number>(bytes, 0);
  }
  std::uint8_t operation() const { return number<std::uint8_t>("op"); }
  void expect(Operation wanted) const {
    if (operation() != wanted) throw std::runtime_error("a record is of an unexpected kind");
  }
};

/// \param container  a file or a chunk, whose `take(offset, size)` refuses what lies outside
template <typename Container>
Record recordAt(Container& container, std::uint64_t offset) {
  Record record;
  const auto header_size = numberAt<std::uint32_t>(container.take(offset, 4), 0);
  record.fields = toFields(container.take(offset + 4, header_size));
  const std::uint64_t length_at = offset + 4 + header_size;
  record.data_size = numberAt<std::uint32_t>(container.take(length_at, 4), 0);
  record.data_offset = length_at + 4;
  return record;
}

void expectInside(std::uint64_t chunk_size, std::uint64_t offset, std::uint64_t size) {
  if (offset > chunk_size || size > chunk_size - offset)
    throw std::runtime_error("a record reaches beyond the end of its chunk");
}

struct ChunkInMemory {
  std::string_view bytes;
  std::string_view take(std::uint64_t offset, std::uint64_t size) const {
    expectInside(bytes.size(), offset, size);
    return bytes.substr(offset, size);
  }
};

/// One that is not compressed: what is not asked for is not read.
template <typename File>
struct ChunkInFile {
  File& file;
  std::uint64_t begin = 0;
  std::uint64_t chunk_size = 0;
  std::string_view take(std::uint64_t offset, std::uint64_t size) const {
    expectInside(chunk_size, offset, size);
    return file.take(begin + offset, size);
  }
};

template <typename Container>
std::string_view messageOf(const BagEntry& entry, const Container& chunk) {
  Record record = recordAt(chunk, entry.offset);
  while (record.operation() == kConnection) record = recordAt(chunk, record.end());
  record.expect(kMessage);
  if (record.number<std::uint32_t>("conn") != entry.connection)
    throw std::runtime_error("a message is not where the index says");
  return chunk.take(record.data_offset, record.data_size);
}

std::string atByte(std::uint64_t offset, const std::string& reason) {
  return "the chunk at byte " + std::to_string(offset) + ": " + reason;
}

}  // namespace

BagFile::File::File(const std::string& path) : file_(path, std::ios::binary | std::ios::ate) {
  if (!file_) throw std::runtime_error("cannot read the bag " + path);
  size_ = static_cast<std::uint64_t>(file_.tellg());
  at_ = size_;
}

std::string_view BagFile::File::take(std::uint64_t offset, std::uint64_t size) {
  if (offset > size_ || size > size_ - offset)
    throw std::runtime_error("a record reaches beyond the end of the file");
  // Seeking empties the buffer of the stream.
  if (offset != at_) file_.seekg(static_cast<std::streamoff>(offset));
  bytes_.resize(size);
  if (!file_.read(bytes_.data(), static_cast<std::streamsize>(size))) {
    file_.clear();
    at_ = size_ + 1;
    throw std::runtime_error("the file cannot be read");
  }
  at_ = offset + size;
  return bytes_;
}

BagFile::BagFile(const std::string& path) : path_(path), file_(path) {
  const std::string repair =
      "; if the recording was cut off, run `rosbag reindex " + path + "`, then try again";
  try {
    readEnd();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("cannot read the bag " + path + " (" + error.what() + ")" + repair);
  }
  std::uint64_t end = 0;  // of the chunk before: they stand one behind the other
  for (const ChunkInfo& info : infos_) {
    const std::size_t known = entries_.size();
    try {
      if (info.offset < end) throw std::runtime_error("it overlaps the one before");
      end = indexChunk(info);
    } catch (const std::runtime_error& error) {
      entries_.resize(known);
      for (const auto& of_connection : info.counts) lost_messages_ += of_connection.second;
      if (damage_.empty()) damage_ = atByte(info.offset, error.what());
    }
  }
  std::stable_sort(
      entries_.begin(), entries_.end(),
      [](const BagEntry& left, const BagEntry& right) { return left.time_ns < right.time_ns; });
}

/// What closing a bag writes: connections, and where the chunks are.
void BagFile::readEnd() {
  const std::string_view magic = "#ROSBAG V2.0\n";
  if (file_.take(0, magic.size()) != magic)
    throw std::runtime_error("its format is not 2.0: `rosbag filter` writes bags of that format");
  const Record header = recordAt(file_, magic.size());
  header.expect(kBagHeader);
  const auto encryptor = header.fields.find("encryptor");
  if (encryptor != header.fields.end() && !encryptor->second.empty())
    throw std::runtime_error("it is encrypted by " + encryptor->second);
  auto at = header.number<std::uint64_t>("index_pos");
  if (at == 0) throw std::runtime_error("it was not closed and has no index");
  for (Record record; at < file_.size(); at = record.end()) {
    record = recordAt(file_, at);
    if (record.operation() == kConnection) {
      takeConnection(at);
      continue;
    }
    record.expect(kChunkInfo);
    ChunkInfo info;
    info.offset = record.number<std::uint64_t>("chunk_pos");
    const std::string_view counts = file_.take(record.data_offset, record.data_size);
    for (std::size_t i = 0; i < counts.size(); i += 8)
      info.counts[numberAt<std::uint32_t>(counts, i)] += numberAt<std::uint32_t>(counts, i + 4);
    infos_.push_back(std::move(info));
  }
  if (connections_.size() != header.number<std::uint32_t>("conn_count") ||
      infos_.size() != header.number<std::uint32_t>("chunk_count"))
    throw std::runtime_error("its index is not complete");
}

void BagFile::takeConnection(std::uint64_t offset) {
  const Record record = recordAt(file_, offset);
  Record description;
  description.fields = toFields(file_.take(record.data_offset, record.data_size));
  connections_.emplace(
      record.number<std::uint32_t>("conn"),
      BagConnection{record.text("topic"), description.text("type"), description.text("md5sum")});
}

std::uint64_t BagFile::indexChunk(const ChunkInfo& info) {
  Record record = recordAt(file_, info.offset);
  record.expect(kChunk);
  const Chunk chunk{info.offset, record.text("compression"), record.number<std::uint32_t>("size"),
                    record.data_offset, record.data_size};
  if (chunk.compression == "none" && chunk.size != chunk.data_size)
    throw std::runtime_error("its two sizes differ");
  for (std::size_t i = 0; i < info.counts.size(); ++i) {
    record = recordAt(file_, record.end());
    record.expect(kIndex);
    const auto number = record.number<std::uint32_t>("conn");
    if (connections_.count(number) == 0 || info.counts.count(number) == 0 ||
        record.number<std::uint32_t>("ver") != 1 ||
        record.data_size != std::uint64_t{12} * info.counts.at(number))
      throw std::runtime_error("its index is damaged");
    const std::string_view entries = file_.take(record.data_offset, record.data_size);
    for (std::size_t at = 0; at < entries.size(); at += 12) {
      const auto seconds = numberAt<std::uint32_t>(entries, at);
      const auto nanoseconds = numberAt<std::uint32_t>(entries, at + 4);
      entries_.push_back({std::int64_t{seconds} * 1'000'000'000 + nanoseconds, number,
                          static_cast<std::uint32_t>(chunks_.size()),
                          numberAt<std::uint32_t>(entries, at + 8)});
    }
  }
  chunks_.push_back(chunk);
  return record.end();
}

std::string_view BagFile::message(const BagEntry& entry) {
  const Chunk& chunk = chunks_.at(entry.chunk);
  try {
    if (chunk.compression == "none")
      return messageOf(entry, ChunkInFile<File>{file_, chunk.data_offset, chunk.data_size});
    loadChunk(entry.chunk);
    return messageOf(entry,
                     ChunkInMemory{{reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}});
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(atByte(chunk.offset, error.what()));
  }
}

void BagFile::loadChunk(std::uint32_t index) {
  const bool is_loaded = !bytes_.empty() || !unreadable_.empty();
  if (!is_loaded || loaded_ != index) {
    loaded_ = index;
    bytes_.clear();
    unreadable_.clear();
    const Chunk& chunk = chunks_[index];
    try {
      bytes_ = uncompressed(chunk.compression, file_.take(chunk.data_offset, chunk.data_size),
                            chunk.size);
    } catch (const std::runtime_error& error) {
      unreadable_ = error.what();
    }
  }
  if (!unreadable_.empty()) throw std::runtime_error(unreadable_);
}

std::string BagFile::damage() const {
  if (damage_.empty()) return "";
  return "left out " + std::to_string(lost_messages_) + " messages of all topics: the bag " +
         path_ + " is damaged (" + damage_ + ")";
}

}  // namespace ramscout_bringup
