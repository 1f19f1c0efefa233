// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/compression.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "recorded_bytes.hpp"

namespace ramscout_bringup {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::string kContent(10'000, 'x');

std::string packed(const std::string& compression) {
  if (compression == "lz4") return ramscout_bringup_ros::lz4(kContent);
  if (compression == "bz2") return ramscout_bringup_ros::bz2(kContent);
  if (compression == "zstd") return ramscout_bringup_ros::zstd(kContent);
  return kContent;
}

class CompressionTest : public ::testing::TestWithParam<std::string> {};

TEST_P(CompressionTest, ContentComesBack) {
  const auto content = uncompressed(GetParam(), packed(GetParam()), kContent.size());
  EXPECT_EQ(std::string(content.begin(), content.end()), kContent);
}

TEST_P(CompressionTest, ContentOfAnotherSizeIsRefused) {
  for (const std::size_t size : {kContent.size() - 1, kContent.size() + 1, std::size_t{0}})
    EXPECT_THROW(uncompressed(GetParam(), packed(GetParam()), size), std::runtime_error) << size;
}

TEST_P(CompressionTest, ChunkThatWasCutIsRefused) {
  const std::string chunk = packed(GetParam());
  EXPECT_THROW(uncompressed(GetParam(), chunk.substr(0, chunk.size() / 2), kContent.size()),
               std::runtime_error);
  EXPECT_THROW(uncompressed(GetParam(), "", kContent.size()), std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(All,
                         CompressionTest,
                         ::testing::Values("none", "lz4", "bz2", "zstd"),
                         [](const auto& name) { return name.param; });

TEST(Compression, AnUnknownOneIsNamed) {
  EXPECT_THAT([] { uncompressed("rar", kContent, kContent.size()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("'rar'")));
}

TEST(Compression, MakesNoRoomForAChunkThatClaimsToBeHuge) {
  EXPECT_THAT([] { uncompressed("bz2", packed("bz2"), std::uint64_t{1} << 40U); },
              ThrowsMessage<std::runtime_error>(HasSubstr("1099511627776 bytes")));
}

}  // namespace
}  // namespace ramscout_bringup
