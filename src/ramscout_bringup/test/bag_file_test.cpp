// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/bag_file.hpp"

#include <cstring>
#include <fstream>
#include <stdexcept>
#include <tuple>

#include <gmock/gmock.h>
#include <ram_slam/io/atomic_file.hpp>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>

namespace ramscout_bringup {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

/// Topic, time, length of the message.
using Messages = std::vector<std::tuple<std::string, std::int64_t, std::size_t>>;

class BagFileTest : public ::testing::Test {
protected:
  ~BagFileTest() override { std::remove(path().c_str()); }
  static std::string path() { return ::testing::TempDir() + "bag_file_test.bag"; }

  /// Twelve messages in three chunks or more, not in the order of their times.
  static std::string write(rosbag::CompressionType compression) {
    rosbag::Bag bag(path(), rosbag::bagmode::Write);
    bag.setCompression(compression);
    bag.setChunkThreshold(500);
    std_msgs::String message;
    for (unsigned int i = 0; i < 12; ++i) {
      message.data = std::string(100 + i, static_cast<char>('a' + i));
      bag.write(i % 3 == 0 ? "/third" : "/others", ros::Time(100 + (i ^ 1U), 5), message);
    }
    bag.close();
    return ram_slam::readWholeFile(path());
  }
  static std::string replaceWith(const std::string& bytes) {
    std::ofstream(path(), std::ios::binary) << bytes;
    return path();
  }

  static Messages readByRosbag() {
    rosbag::Bag bag(path(), rosbag::bagmode::Read);
    Messages messages;
    for (const rosbag::MessageInstance& message : rosbag::View(bag))
      messages.emplace_back(message.getTopic(),
                            static_cast<std::int64_t>(message.getTime().toNSec()), message.size());
    return messages;
  }
  /// Leaves out what is damaged.
  static Messages readAll() {
    BagFile bag(path());
    Messages messages;
    damage_ = bag.damage();
    for (const BagEntry& entry : bag.entries()) {
      try {
        const std::string_view bytes = bag.message(entry);
        messages.emplace_back(bag.connections().at(entry.connection).topic, entry.time_ns,
                              bytes.size());
      } catch (const std::runtime_error& error) {
        damage_ = error.what();
      }
    }
    return messages;
  }
  /// The place of the `number`th text in the file.
  static std::size_t find(const std::string& bytes, const std::string& text, int number) {
    std::size_t at = bytes.find(text);
    for (; number > 0; --number) at = bytes.find(text, at + 1);
    return at;
  }
  static std::string damage_;
};
std::string BagFileTest::damage_;

TEST_F(BagFileTest, GivesWhatRosbagGives) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::LZ4, rosbag::compression::BZ2}) {
    write(compression);
    EXPECT_EQ(readAll(), readByRosbag()) << compression;
    EXPECT_THAT(damage_, IsEmpty());
  }
  const BagFile bag(path());
  EXPECT_EQ(bag.connections().at(0).type, "std_msgs/String");
  EXPECT_EQ(bag.connections().at(0).md5sum, ros::message_traits::md5sum<std_msgs::String>());
}

TEST_F(BagFileTest, EveryBagThatWasCutIsRefusedByNameAndReason) {
  const std::string whole = write(rosbag::compression::LZ4);
  for (std::size_t size = 0; size < whole.size(); size += size < 4000 ? 397 : 7) {
    replaceWith(whole.substr(0, size));
    EXPECT_THAT([] { BagFile{path()}; },
                ThrowsMessage<std::runtime_error>(
                    AllOf(HasSubstr(path() + " ("), HasSubstr("rosbag reindex"))))
        << size;
  }
}

TEST_F(BagFileTest, BagWithoutAnIndexOfAnotherVersionOrEncryptedIsRefused) {
  const auto refusal = [](const std::string& reason) {
    return ThrowsMessage<std::runtime_error>(HasSubstr(reason));
  };
  const std::string whole = write(rosbag::compression::LZ4);
  std::string bytes = whole;
  bytes.replace(bytes.find("index_pos=") + 10, 8, 8, '\0');
  replaceWith(bytes);
  EXPECT_THAT([] { BagFile{path()}; }, refusal("was not closed"));
  replaceWith("#ROSBAG V1.2\n" + whole.substr(13));
  EXPECT_THAT([] { BagFile{path()}; }, refusal("format is not 2.0"));
  bytes = whole;
  bytes.replace(bytes.find("chunk_count="), 16, "encryptor=aes123");
  replaceWith(bytes);
  EXPECT_THAT([] { BagFile{path()}; }, refusal("encrypted by aes123"));
  EXPECT_THAT([] { BagFile{path() + ".none"}; }, refusal("cannot read the bag"));
}

TEST_F(BagFileTest, BagWhoseIndexLacksAChunkIsRefused) {
  std::string bytes = write(rosbag::compression::LZ4);
  bytes[bytes.find("chunk_count=") + 12] = 2;
  replaceWith(bytes);
  EXPECT_THAT([] { BagFile{path()}; },
              ThrowsMessage<std::runtime_error>(HasSubstr("index is not complete")));
}

TEST_F(BagFileTest, ChunkWhoseHeaderOrIndexIsDamagedIsLeftOutAndCounted) {
  const std::string whole = write(rosbag::compression::Uncompressed);
  for (const std::string field : {"compression=", "size=", "ver=", "count="}) {
    std::string bytes = whole;
    bytes[find(bytes, field, 1)] = '!';
    if (field == "count=") {
      bytes = whole;  // the length of the index's data behind its header
      const std::uint32_t length = 0xfffffff0;
      std::memcpy(&bytes[find(bytes, "ver=", 2) + 8], &length, sizeof(length));
    }
    replaceWith(bytes);
    const std::size_t read_count = readAll().size();
    EXPECT_GT(read_count, 6U) << field;
    EXPECT_THAT(damage_, AllOf(HasSubstr("left out " + std::to_string(12 - read_count) +
                                         " messages of all topics: the bag " + path()),
                               HasSubstr("the chunk at byte ")))
        << field;
  }
}

TEST_F(BagFileTest, ChunkThatCannotBeUncompressedCostsItsMessagesOnly) {
  std::string bytes = write(rosbag::compression::BZ2);
  bytes.replace(find(bytes, "BZh", 1), 20, 20, '\xff');
  replaceWith(bytes);
  EXPECT_GT(readAll().size(), 6U);
  EXPECT_THAT(damage_, AllOf(HasSubstr("the chunk at byte "), HasSubstr("cannot be decompressed")));
}

TEST_F(BagFileTest, LengthInsideAChunkThatReachesBeyondItIsRefused) {
  const std::string whole = write(rosbag::compression::Uncompressed);
  const Messages messages = readAll();
  const std::size_t text_at = whole.find(std::string(100, 'a'));
  for (const std::size_t back : {8U, 51U}) {  // the message's length, and that of its header
    std::string bytes = whole;
    const std::uint32_t length = 0xfffffff0;
    std::memcpy(&bytes[text_at - back], &length, sizeof(length));
    replaceWith(bytes);
    EXPECT_EQ(readAll().size(), messages.size() - 1) << back;
    EXPECT_THAT(damage_, HasSubstr("beyond the end of its chunk"));
  }
}

TEST_F(BagFileTest, MessageThatIsNotWhereTheIndexSaysIsRefused) {
  std::string bytes = write(rosbag::compression::Uncompressed);
  const std::size_t message_at = bytes.find(std::string(100, 'a'));
  bytes[bytes.rfind("conn=", message_at) + 5] = 1;
  replaceWith(bytes);
  EXPECT_EQ(readAll().size(), 11U);
  EXPECT_THAT(damage_, HasSubstr("not where the index says"));
}

TEST_F(BagFileTest, ChunksThatOverlapAreReadOnce) {
  std::string bytes = write(rosbag::compression::Uncompressed);
  const std::size_t first = find(bytes, "chunk_pos=", 0) + 10;
  const std::size_t second = find(bytes, "chunk_pos=", 1) + 10;
  bytes.replace(second, 8, bytes.substr(first, 8));
  replaceWith(bytes);
  readAll();
  EXPECT_THAT(damage_, HasSubstr("it overlaps the one before"));
}

}  // namespace
}  // namespace ramscout_bringup
