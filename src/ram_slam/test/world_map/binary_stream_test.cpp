// SPDX-License-Identifier: BSD-3-Clause
#include "../../src/world_map/binary_stream.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

TEST(BinaryWriter, WritesTheLeastSignificantByteFirst) {
  BinaryWriter writer;
  writer.write(std::uint32_t{0x01020304});
  writer.write(std::int8_t{-1});
  EXPECT_EQ(writer.bytes(), std::string("\x04\x03\x02\x01\xff"));
}

TEST(BinaryWriter, WritesFloatingPointNumbersAsIeee754) {
  BinaryWriter writer;
  writer.write(1.0F);  // 0x3f800000
  writer.write(-2.0);  // 0xc000000000000000
  EXPECT_EQ(writer.bytes(), std::string("\x00\x00\x80\x3f\x00\x00\x00\x00\x00\x00\x00\xc0", 12));
}

TEST(BinaryReader, GivesBackWhatWasWritten) {
  BinaryWriter writer;
  writer.write(std::int64_t{-5});
  writer.write(std::numeric_limits<std::uint64_t>::max());
  writer.write(std::string("a\0b", 3));
  writer.write(std::numeric_limits<double>::infinity());
  const Eigen::Matrix3d matrix = Eigen::Matrix3d::Random();
  writer.write(matrix);
  BinaryReader reader(writer.bytes());
  EXPECT_EQ(reader.read<std::int64_t>(), -5);
  EXPECT_EQ(reader.read<std::uint64_t>(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(reader.readText(), std::string("a\0b", 3));
  EXPECT_TRUE(std::isinf(reader.read<double>()));
  EXPECT_EQ(reader.readMatrix<Eigen::Matrix3d>(), matrix);
  EXPECT_TRUE(reader.atEnd());
}

TEST(BinaryReader, RefusesToReadPastTheEnd) {
  const std::string bytes("\x01\x02\x03", 3);
  BinaryReader reader(bytes);
  EXPECT_THROW(reader.read<std::uint32_t>(), std::runtime_error);
  EXPECT_EQ(reader.position(), 0U);
  EXPECT_EQ(reader.read<std::uint16_t>(), 0x0201);
}

TEST(BinaryReader, RefusesCountsThatTheRestCannotHold) {
  BinaryWriter writer;
  writer.write(std::uint64_t{3});
  writer.write(std::uint64_t{0});
  BinaryReader fits(writer.bytes());
  EXPECT_EQ(fits.readCount(2), 3U);
  BinaryReader too_many(writer.bytes());
  EXPECT_THROW(too_many.readCount(4), std::runtime_error);
}

}  // namespace
}  // namespace ram_slam
