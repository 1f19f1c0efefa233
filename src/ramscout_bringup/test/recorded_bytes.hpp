// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Recordings written byte by byte after the specifications of their formats.

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

namespace ramscout_bringup_ros {

using Bytes = std::string;

template <typename Number>
inline void put(Bytes& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
inline void putText(Bytes& bytes, const std::string& text) {
  put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

/// Little-endian CDR: values aligned to their size, counted from behind the four bytes of header;
/// strings end with a zero.
class CdrWriter {
public:
  template <typename Number>
  CdrWriter& operator<<(Number value) {
    while ((bytes_.size() - 4) % sizeof(value) != 0) bytes_.push_back('\0');
    put(bytes_, value);
    return *this;
  }
  CdrWriter& operator<<(const std::string& text) {
    *this << static_cast<std::uint32_t>(text.size() + 1);
    bytes_ += text;
    bytes_.push_back('\0');
    return *this;
  }
  const Bytes& bytes() const { return bytes_; }

private:
  Bytes bytes_{'\0', '\1', '\0', '\0'};
};

inline Bytes scanBytes(std::int32_t seconds) {
  CdrWriter cdr;
  cdr << seconds << std::uint32_t{500'000'000} << std::string("laser");
  for (const float value : {-1.0F, 1.0F, 0.5F, 0.001F, 0.1F, 0.05F, 12.0F}) cdr << value;
  cdr << std::uint32_t{3} << 1.0F << 2.0F << 3.0F << std::uint32_t{0};
  return cdr.bytes();
}

inline Bytes odometryBytes() {
  CdrWriter cdr;
  cdr << std::int32_t{7} << std::uint32_t{0} << std::string("odom") << std::string("base_link");
  for (const double value : {1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0}) cdr << value;
  for (int i = 0; i < 36; ++i) cdr << 0.0;
  for (const double value : {0.5, 0.0, 0.0, 0.0, 0.0, 0.25}) cdr << value;
  for (int i = 0; i < 36; ++i) cdr << 0.0;
  return cdr.bytes();
}

inline Bytes transformBytes() {
  CdrWriter cdr;
  cdr << std::uint32_t{1} << std::int32_t{9} << std::uint32_t{0} << std::string("odom")
      << std::string("base_link");
  for (const double value : {3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0}) cdr << value;
  return cdr.bytes();
}

inline Bytes record(std::uint8_t opcode, const Bytes& content) {
  Bytes bytes;
  put(bytes, opcode);
  put(bytes, static_cast<std::uint64_t>(content.size()));
  return bytes + content;
}

inline Bytes messageRecord(std::uint64_t time_ns, const Bytes& data) {
  Bytes content;
  put(content, std::uint16_t{1});
  put(content, std::uint32_t{0});
  put(content, time_ns);
  put(content, time_ns);
  return record(5, content + data);
}

inline Bytes chunk(const std::string& compression, const Bytes& records, std::uint64_t size) {
  Bytes content;
  put(content, std::uint64_t{0});
  put(content, std::uint64_t{0});
  put(content, size);
  put(content, std::uint32_t{0});
  putText(content, compression);
  put(content, static_cast<std::uint64_t>(records.size()));
  return record(6, content + records);
}

inline Bytes zstd(const Bytes& bytes) {
  Bytes result(ZSTD_compressBound(bytes.size()), '\0');
  result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 1));
  return result;
}

inline Bytes lz4(const Bytes& bytes) {
  Bytes result(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  result.resize(
      LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), nullptr));
  return result;
}

inline Bytes bz2(Bytes bytes) {
  auto size = static_cast<unsigned int>(bytes.size() + bytes.size() / 100 + 600);
  Bytes result(size, '\0');
  BZ2_bzBuffToBuffCompress(result.data(), &size, bytes.data(),
                           static_cast<unsigned int>(bytes.size()), 1, 0, 0);
  result.resize(size);
  return result;
}

inline const Bytes kMagic("\x89MCAP0\r\n", 8);

/// Header, the schema and the channel of /scan.
inline Bytes beginning() {
  Bytes header;
  putText(header, "ros2");
  putText(header, "test");
  Bytes schema;
  put(schema, std::uint16_t{1});
  putText(schema, "sensor_msgs/msg/LaserScan");
  putText(schema, "ros2msg");
  putText(schema, "");
  Bytes channel;
  put(channel, std::uint16_t{1});
  put(channel, std::uint16_t{1});
  putText(channel, "/scan");
  putText(channel, "cdr");
  putText(channel, "");
  return kMagic + record(1, header) + record(3, schema) + record(4, channel);
}

struct DatabaseRow {
  int topic = 0;  ///< 1: odometry on /odom, 2: scans on /scan
  int time_ns = 0;
  Bytes data;
};
/// Writes a database as rosbag2 does.
inline void writeDatabase(const std::string& path, const std::vector<DatabaseRow>& rows) {
  const auto hex = [](const Bytes& bytes) {
    std::string text;
    for (const char byte : bytes) {
      constexpr const char* kDigits = "0123456789abcdef";
      text += kDigits[static_cast<unsigned char>(byte) >> 4U];
      text += kDigits[static_cast<unsigned char>(byte) & 15U];
    }
    return "x'" + text + "'";
  };
  std::string sql =
      "PRAGMA page_size = 512;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
      "TEXT, "
      "offered_qos_profiles TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
      "BLOB);"
      "INSERT INTO topics VALUES(1, '/odom', 'nav_msgs/msg/Odometry', 'cdr', '');"
      "INSERT INTO topics VALUES(2, '/scan', 'sensor_msgs/msg/LaserScan', 'cdr', '');";
  for (const DatabaseRow& row : rows) {
    sql += "INSERT INTO messages(topic_id, timestamp, data) VALUES(" + std::to_string(row.topic) +
           ", " + std::to_string(row.time_ns) + ", " + hex(row.data) + ");";
  }
  std::remove(path.c_str());
  sqlite3* database = nullptr;
  const bool is_written =
      sqlite3_open(path.c_str(), &database) == SQLITE_OK &&
      sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
  sqlite3_close(database);
  if (!is_written) throw std::runtime_error("cannot write the database " + path);
}

}  // namespace ramscout_bringup_ros
