// SPDX-License-Identifier: BSD-3-Clause
// The formats of recordings, against files written byte by byte after their specifications.
#include "../ros/message_source.hpp"

#include <cstring>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <ros/serialization.h>

#include "../ros/message_decoder.hpp"
#include "recorded_bytes.hpp"

namespace ramscout_bringup_ros {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

/// As ROS 1 writes it.
template <typename Message>
Bytes packed(const Message& message) {
  Bytes bytes(ros::serialization::serializationLength(message), '\0');
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

template <typename Message>
void expectRefusedWithALongerList(const Message& message, std::size_t count_at) {
  const std::string type = ros::message_traits::datatype<Message>();
  const auto read = [&type](const Bytes& bytes) {
    decode(type, "ros1", reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  };
  Bytes bytes = packed(message);
  EXPECT_NO_THROW(read(bytes));
  bytes.replace(count_at, 4, "\xff\xff\xff\x7f");
  EXPECT_THAT([&] { read(bytes); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("too short for a list")));
}

TEST(MessageDecoder, MakesNoRoomForAListOfRos1ThatTheMessageDoesNotHave) {
  sensor_msgs::LaserScan scan;
  scan.ranges = {1.0F, 2.0F};
  expectRefusedWithALongerList(scan, 16 + 28);
  sensor_msgs::MultiEchoLaserScan echoes;
  echoes.ranges.resize(1);
  echoes.ranges[0].echoes = {1.0F};
  expectRefusedWithALongerList(echoes, 16 + 28);
  expectRefusedWithALongerList(echoes, 16 + 28 + 4);
  tf2_msgs::TFMessage transforms;
  transforms.transforms.resize(1);
  expectRefusedWithALongerList(transforms, 0);
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
  writeDatabase(path(),
                {{1, 200, odometryBytes()}, {1, 100, odometryBytes()}, {1, 300, Bytes("\0\1", 2)}});
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
