// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/world_map_file.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "example_world.hpp"

namespace ram_slam {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(WorldMapFile, GivesBackTheWholeMap) {
  const WorldMap map = exampleWorld();
  const WorldMap read = worldMapFromBytes(toBytes(map));
  EXPECT_EQ(toBytes(read), toBytes(map));

  ASSERT_EQ(read.occupancies().size(), 2u);
  const LocalOccupancy& room = *read.occupancies().at("room");
  EXPECT_EQ(room.stamp_ns, 20);
  EXPECT_EQ(room.grid.cells, map.occupancies().at("room")->grid.cells);
  EXPECT_EQ(room.grid.resolution_m, 0.5);
  EXPECT_TRUE(room.map_from_frame.transform().isApprox(
      map.occupancies().at("room")->map_from_frame.transform(), 1e-15));
  EXPECT_EQ(room.map_from_frame.covariance(0, 5), 2e-4);

  ASSERT_EQ(read.landmarks().landmarks.size(), 3u);
  const WorldLandmark& landmark = read.landmarks().landmarks[1];
  EXPECT_EQ(landmark.id, 4u);
  EXPECT_EQ(landmark.stamp_ns, 77);
  EXPECT_EQ(landmark.type, "corner");
  EXPECT_EQ(landmark.classifier, std::string("pg1:\0:x", 7));
  EXPECT_EQ(landmark.existence_log_odds, 2.5);
  EXPECT_EQ(read.landmarks().cross_covariances[2].covariance_m2,
            map.landmarks().cross_covariances[2].covariance_m2);

  EXPECT_EQ(read.clouds().at("camera")->points[1].rgb, 0x00ff00U);
  EXPECT_EQ(read.clouds().at("camera")->points[1].x_m, 2.0F);
  ASSERT_EQ(read.trajectory().size(), 2u);
  EXPECT_EQ(read.trajectory()[1].stamp_ns, 200);
  EXPECT_EQ(read.trajectory()[1].pose.yaw_rad, 0.25);

  ASSERT_EQ(read.scans().size(), 2u);
  EXPECT_EQ(read.scans()[1].scan.stamp_ns, 50);
  EXPECT_EQ(read.scans()[1].scan.ranges_m, map.scans()[1].scan.ranges_m);
  EXPECT_EQ(read.scans()[1].map_from_laser.x_m, 2.0);
  EXPECT_EQ(read.scans()[1].last_beam.yaw_rad, 0.001);
}

TEST(WorldMapFile, BytesAreTheSameOnEveryMachine) {
  const std::string bytes = toBytes(WorldMap());
  EXPECT_EQ(bytes.substr(0, 20), std::string("RAMWORLD\2\0\0\0\x38\0\0\0\0\0\0\0", 20));
  EXPECT_EQ(bytes.size(), 28u + 7 * 8);  // six counts and a stamp, all zero
}

TEST(WorldMapFile, RefusesAFileCutAnywhere) {
  const std::string bytes = toBytes(exampleWorld());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(worldMapFromBytes(bytes.substr(0, size)), std::runtime_error) << size;
  }
  EXPECT_THROW(worldMapFromBytes(bytes + '\0'), std::runtime_error);
}

TEST(WorldMapFile, RefusesAFileWithAnyBitFlipped) {
  const std::string bytes = toBytes(exampleWorld());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string flipped = bytes;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    EXPECT_THROW(worldMapFromBytes(flipped), std::runtime_error) << bit;
  }
}

TEST(WorldMapFile, NamesWhatIsWrong) {
  const std::string bytes = toBytes(exampleWorld());
  EXPECT_THAT([] { worldMapFromBytes(""); },
              ThrowsMessage<std::runtime_error>(HasSubstr("not a world map")));
  std::string newer = bytes;
  newer[8] = 3;
  EXPECT_THAT([&] { worldMapFromBytes(newer); },
              ThrowsMessage<std::runtime_error>(HasSubstr("version 3")));
  std::string damaged = bytes;
  damaged.back() = 'x';
  EXPECT_THAT([&] { worldMapFromBytes(damaged); },
              ThrowsMessage<std::runtime_error>(HasSubstr("damaged")));
}

TEST(WorldMapFile, OfTheVersionWithoutScansIsStillRead) {
  WorldMap map = exampleWorld();
  map.put(std::vector<PlacedScan>{});
  std::string bytes = toBytes(map);
  bytes.resize(bytes.size() - 8);  // the number of scans
  const std::string content = bytes.substr(28);
  bytes[8] = 1;
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char byte : content)
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[12 + i] = static_cast<char>(content.size() >> (8 * i));
    bytes[20 + i] = static_cast<char>(hash >> (8 * i));
  }
  const WorldMap read = worldMapFromBytes(bytes);
  EXPECT_EQ(read.landmarks().landmarks.size(), 3u);
  EXPECT_TRUE(read.scans().empty());
}

/// A file that is whole, with a checksum that is right, but counts that are not.
TEST(WorldMapFile, AllocatesNothingForCountsThatTheFileCannotHold) {
  std::string bytes = toBytes(WorldMap());
  const std::string good_checksum = bytes.substr(20, 8);
  for (std::size_t i = 28; i < 36; ++i) bytes[i] = '\xff';
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (std::size_t i = 28; i < bytes.size(); ++i) {
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3ULL;
  }
  for (std::size_t i = 0; i < 8; ++i) bytes[20 + i] = static_cast<char>(hash >> (8 * i));
  ASSERT_NE(bytes.substr(20, 8), good_checksum);
  EXPECT_THAT([&] { worldMapFromBytes(bytes); },
              ThrowsMessage<std::runtime_error>(HasSubstr("cut short")));
}

}  // namespace
}  // namespace ram_slam
