// SPDX-License-Identifier: BSD-3-Clause
// The formats of recordings, against files written byte by byte after their specifications.
#include "../ros/message_source.hpp"

#include <cstring>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include "../ros/message_decoder.hpp"

namespace ramscout_bringup_ros {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Bytes = std::string;

template <typename Number>
void put(Bytes& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
void putText(Bytes& bytes, const std::string& text) {
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

Bytes scanBytes(std::int32_t seconds) {
  CdrWriter cdr;
  cdr << seconds << std::uint32_t{500'000'000} << std::string("laser");
  for (const float value : {-1.0F, 1.0F, 0.5F, 0.001F, 0.1F, 0.05F, 12.0F}) cdr << value;
  cdr << std::uint32_t{3} << 1.0F << 2.0F << 3.0F << std::uint32_t{0};
  return cdr.bytes();
}

Bytes odometryBytes() {
  CdrWriter cdr;
  cdr << std::int32_t{7} << std::uint32_t{0} << std::string("odom") << std::string("base_link");
  for (const double value : {1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0}) cdr << value;
  for (int i = 0; i < 36; ++i) cdr << 0.0;
  for (const double value : {0.5, 0.0, 0.0, 0.0, 0.0, 0.25}) cdr << value;
  for (int i = 0; i < 36; ++i) cdr << 0.0;
  return cdr.bytes();
}

Bytes transformBytes() {
  CdrWriter cdr;
  cdr << std::uint32_t{1} << std::int32_t{9} << std::uint32_t{0} << std::string("odom")
      << std::string("base_link");
  for (const double value : {3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0}) cdr << value;
  return cdr.bytes();
}

MessageContent decoded(const std::string& type, const Bytes& bytes) {
  return decode(type, "cdr", reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TEST(MessageDecoder, ReadsMessagesOfRos2) {
  const auto scan =
      std::get<sensor_msgs::LaserScan>(decoded("sensor_msgs/LaserScan", scanBytes(5)));
  EXPECT_EQ(scan.header.stamp, ros::Time(5, 500'000'000));
  EXPECT_EQ(scan.header.frame_id, "laser");
  EXPECT_FLOAT_EQ(scan.range_max, 12.0F);
  EXPECT_THAT(scan.ranges, ElementsAre(1.0F, 2.0F, 3.0F));
  const auto odometry = std::get<nav_msgs::Odometry>(decoded("nav_msgs/Odometry", odometryBytes()));
  EXPECT_EQ(odometry.child_frame_id, "base_link");
  EXPECT_EQ(odometry.pose.pose.position.y, 2.0);
  EXPECT_EQ(odometry.twist.twist.angular.z, 0.25);
  const auto tf = std::get<tf2_msgs::TFMessage>(decoded("tf2_msgs/TFMessage", transformBytes()));
  EXPECT_EQ(tf.transforms.at(0).transform.translation.y, 4.0);
}

TEST(MessageDecoder, RefusesEveryMessageThatIsCutShort) {
  const Bytes whole = scanBytes(5);
  for (std::size_t size = 0; size + 4 < whole.size(); ++size)
    EXPECT_THROW(decoded("sensor_msgs/LaserScan", whole.substr(0, size)), std::runtime_error)
        << size;
}

TEST(MessageDecoder, RefusesALengthThatTheMessageDoesNotHave) {
  Bytes bytes = scanBytes(5);
  const std::uint32_t many = 0x7fffffff;
  std::memcpy(&bytes[bytes.size() - 20], &many, sizeof(many));  // the number of ranges
  EXPECT_THROW(decoded("sensor_msgs/LaserScan", bytes), std::runtime_error);
}

TEST(MessageDecoder, KnowsTheNamesOfBothVersionsOfRos) {
  EXPECT_EQ(ros1TypeName("sensor_msgs/msg/LaserScan"), "sensor_msgs/LaserScan");
  EXPECT_EQ(ros1TypeName("nav_msgs/Odometry"), "nav_msgs/Odometry");
  EXPECT_EQ(ros1TypeName("tf/tfMessage"), "tf2_msgs/TFMessage");
}

class SourceTest : public ::testing::Test {
protected:
  ~SourceTest() override { std::remove(path().c_str()); }
  static std::string path() {
    return ::testing::TempDir() + ::testing::UnitTest::GetInstance()->current_test_info()->name();
  }
};

Bytes record(std::uint8_t opcode, const Bytes& content) {
  Bytes bytes;
  put(bytes, opcode);
  put(bytes, static_cast<std::uint64_t>(content.size()));
  return bytes + content;
}

Bytes messageRecord(std::uint64_t time_ns, const Bytes& data) {
  Bytes content;
  put(content, std::uint16_t{1});
  put(content, std::uint32_t{0});
  put(content, time_ns);
  put(content, time_ns);
  return record(5, content + data);
}

Bytes chunk(const std::string& compression, const Bytes& records, std::uint64_t size) {
  Bytes content;
  put(content, std::uint64_t{0});
  put(content, std::uint64_t{0});
  put(content, size);
  put(content, std::uint32_t{0});
  putText(content, compression);
  put(content, static_cast<std::uint64_t>(records.size()));
  return record(6, content + records);
}

Bytes zstd(const Bytes& bytes) {
  Bytes result(ZSTD_compressBound(bytes.size()), '\0');
  result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 1));
  return result;
}

Bytes lz4(const Bytes& bytes) {
  Bytes result(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  result.resize(
      LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), nullptr));
  return result;
}

const Bytes kMagic("\x89MCAP0\r\n", 8);

/// Header, the schema and the channel of /scan.
Bytes beginning() {
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

class McapTest : public SourceTest {
protected:
  static std::vector<std::int64_t> timesIn(const Bytes& file) {
    std::ofstream(path(), std::ios::binary) << file;
    source_ = openMcap(path());
    source_->restart({"/scan"});
    std::vector<std::int64_t> times;
    while (const auto message = source_->next()) times.push_back(message->received_ns);
    return times;
  }
  static std::unique_ptr<MessageSource> source_;
};
std::unique_ptr<MessageSource> McapTest::source_;

TEST_F(McapTest, ReadsMessagesAloneAndInChunksOfEachCompression) {
  const Bytes third = messageRecord(3, scanBytes(3));
  const Bytes fourth = messageRecord(4, scanBytes(4));
  const Bytes file =
      beginning() + messageRecord(1, scanBytes(1)) +
      chunk("", messageRecord(2, scanBytes(2)), messageRecord(2, scanBytes(2)).size()) +
      chunk("zstd", zstd(third), third.size()) + chunk("lz4", lz4(fourth), fourth.size()) +
      record(15, Bytes(4, '\0'));
  EXPECT_THAT(timesIn(file), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(source_->topics().at(0).message_count, 4U);
  EXPECT_TRUE(source_->notes().empty());
}

TEST_F(McapTest, RecordingThatWasCutOffIsReadAsFarAsItGoes) {
  const Bytes file = beginning() + messageRecord(1, scanBytes(1)) + messageRecord(2, scanBytes(2));
  EXPECT_THAT(timesIn(file.substr(0, file.size() - 5)), ElementsAre(1));
  EXPECT_THAT(source_->notes(), Contains(HasSubstr("ends early")));
}

TEST_F(McapTest, ChunkThatClaimsToBeHugeOrOfAnotherSizeEndsTheReading) {
  const Bytes records = messageRecord(2, scanBytes(2));
  for (const std::uint64_t size : {std::uint64_t{1} << 40U, std::uint64_t{records.size() - 1}}) {
    const Bytes file =
        beginning() + messageRecord(1, scanBytes(1)) + chunk("zstd", zstd(records), size);
    EXPECT_THAT(timesIn(file), ElementsAre(1));
    EXPECT_FALSE(source_->notes().empty());
  }
}

TEST_F(SourceTest, DatabaseOfRosbag2IsReadInTheOrderOfItsTimes) {
  sqlite3* database = nullptr;
  std::remove(path().c_str());
  ASSERT_EQ(sqlite3_open(path().c_str(), &database), SQLITE_OK);
  const auto run = [&](const std::string& sql) {
    ASSERT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sql;
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
      "TEXT, "
      "offered_qos_profiles TEXT)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
      "BLOB)");
  run("INSERT INTO topics VALUES(1, '/odom', 'nav_msgs/msg/Odometry', 'cdr', '')");
  const auto hex = [](const Bytes& bytes) {
    std::string text;
    for (const char byte : bytes) {
      constexpr const char* kDigits = "0123456789abcdef";
      text += kDigits[static_cast<unsigned char>(byte) >> 4U];
      text += kDigits[static_cast<unsigned char>(byte) & 15U];
    }
    return "x'" + text + "'";
  };
  run("INSERT INTO messages VALUES(1, 1, 200, " + hex(odometryBytes()) + ")");
  run("INSERT INTO messages VALUES(2, 1, 100, " + hex(odometryBytes()) + ")");
  run("INSERT INTO messages VALUES(3, 1, 300, x'0001')");
  sqlite3_close(database);
  const auto source = openSqlite(path());
  EXPECT_EQ(source->topics().at(0).type, "nav_msgs/Odometry");
  source->restart({"/odom"});
  EXPECT_EQ(source->next().value().received_ns, 100);
  EXPECT_EQ(source->next().value().received_ns, 200);
  EXPECT_FALSE(source->next()) << "the third one is damaged";
  EXPECT_THAT(source->notes(), Contains(HasSubstr("left out 1 messages")));
  source->restart({"/odom"});
  EXPECT_TRUE(source->notes().empty()) << "each reading counts by itself";
}

TEST_F(SourceTest, FileThatIsNoneOfTheFormatsIsRefused) {
  std::ofstream(path()) << "SQLite format 3";
  EXPECT_THROW(openSqlite(path()), std::runtime_error);
  std::ofstream(path()) << "#ROSBAG V2.0\n";
  EXPECT_THROW(openBag(path()), std::runtime_error);
  std::ofstream(path(), std::ios::binary) << kMagic;
  EXPECT_THROW(openMcap(path()), std::runtime_error);
}

}  // namespace
}  // namespace ramscout_bringup_ros
