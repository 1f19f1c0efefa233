// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/world_map_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "binary_stream.hpp"

namespace ram_slam {
namespace {

// The format: see toBytes().
const std::string kMagic = "RAMWORLD";
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kVersionWithoutScans = 1;

std::uint64_t checksum(const std::string& bytes, std::size_t start) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (std::size_t i = start; i < bytes.size(); ++i) {
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3ULL;
  }
  return hash;
}

void write(BinaryWriter& writer, const SpatialPose& pose) {
  writer.write(pose.position_m);
  writer.write(pose.orientation.coeffs());
  writer.write(pose.covariance);
}

void write(BinaryWriter& writer, const Pose2& pose) {
  writer.write(pose.x_m);
  writer.write(pose.y_m);
  writer.write(pose.yaw_rad);
}

void write(BinaryWriter& writer, const LocalOccupancy& occupancy) {
  writer.write(occupancy.stamp_ns);
  writer.write(occupancy.frame);
  write(writer, occupancy.map_from_frame);
  writer.write(occupancy.grid.resolution_m);
  write(writer, occupancy.grid.map_from_grid);
  writer.write(std::int32_t{occupancy.grid.width});
  writer.write(std::int32_t{occupancy.grid.height});
  writer.write(static_cast<std::uint64_t>(occupancy.grid.cells.size()));
  for (const std::int8_t cell : occupancy.grid.cells) writer.write(cell);
}

void write(BinaryWriter& writer, const WorldLandmark& landmark) {
  writer.write(landmark.id);
  writer.write(landmark.stamp_ns);
  writer.write(landmark.type);
  writer.write(landmark.classifier);
  write(writer, landmark.pose);
  writer.write(landmark.existence_log_odds);
}

void write(BinaryWriter& writer, const LandmarkCrossCovariance& block) {
  writer.write(block.first_id);
  writer.write(block.second_id);
  writer.write(block.covariance_m2);
}

void write(BinaryWriter& writer, const LandmarkLayer& layer) {
  writer.write(layer.stamp_ns);
  writer.write(static_cast<std::uint64_t>(layer.landmarks.size()));
  for (const WorldLandmark& landmark : layer.landmarks) write(writer, landmark);
  writer.write(static_cast<std::uint64_t>(layer.cross_covariances.size()));
  for (const LandmarkCrossCovariance& block : layer.cross_covariances) write(writer, block);
}

void write(BinaryWriter& writer, const ColoredPoint& point) {
  writer.write(point.x_m);
  writer.write(point.y_m);
  writer.write(point.z_m);
  writer.write(point.rgb);
}

void write(BinaryWriter& writer, const ColoredCloud& cloud) {
  writer.write(cloud.stamp_ns);
  writer.write(cloud.frame);
  write(writer, cloud.map_from_frame);
  writer.write(static_cast<std::uint64_t>(cloud.points.size()));
  for (const ColoredPoint& point : cloud.points) write(writer, point);
}

void write(BinaryWriter& writer, const StampedPose2& pose) {
  writer.write(pose.stamp_ns);
  write(writer, pose.pose);
}

void write(BinaryWriter& writer, const Trajectory& trajectory) {
  writer.write(static_cast<std::uint64_t>(trajectory.size()));
  for (const StampedPose2& pose : trajectory) write(writer, pose);
}

void write(BinaryWriter& writer, const LaserScan& scan) {
  writer.write(scan.stamp_ns);
  writer.write(scan.angle_min_rad);
  writer.write(scan.angle_increment_rad);
  writer.write(scan.time_increment_s);
  writer.write(scan.range_min_m);
  writer.write(scan.range_max_m);
  writer.write(static_cast<std::uint64_t>(scan.ranges_m.size()));
  for (const float range_m : scan.ranges_m) writer.write(range_m);
}

void write(BinaryWriter& writer, const PlacedScan& placed) {
  write(writer, placed.scan);
  write(writer, placed.base_from_laser);
  write(writer, placed.map_from_laser);
  write(writer, placed.last_beam);
}

/// How many elements follow: never more than the rest of the file can hold, given the bytes of one
/// with empty texts and lists.
template <typename Element>
std::size_t readCountOf(BinaryReader& reader) {
  BinaryWriter least;
  write(least, Element{});
  return reader.readCount(least.bytes().size());
}

SpatialPose readPose(BinaryReader& reader) {
  SpatialPose pose;
  pose.position_m = reader.readMatrix<Eigen::Vector3d>();
  pose.orientation.coeffs() = reader.readMatrix<Eigen::Vector4d>();
  pose.covariance = reader.readMatrix<Eigen::Matrix<double, 6, 6>>();
  return pose;
}

Pose2 readPose2(BinaryReader& reader) {
  Pose2 pose;
  pose.x_m = reader.read<double>();
  pose.y_m = reader.read<double>();
  pose.yaw_rad = reader.read<double>();
  return pose;
}

LocalOccupancy readOccupancy(BinaryReader& reader) {
  LocalOccupancy occupancy;
  occupancy.stamp_ns = reader.read<std::int64_t>();
  occupancy.frame = reader.readText();
  occupancy.map_from_frame = readPose(reader);
  occupancy.grid.resolution_m = reader.read<double>();
  occupancy.grid.map_from_grid = readPose2(reader);
  occupancy.grid.width = reader.read<std::int32_t>();
  occupancy.grid.height = reader.read<std::int32_t>();
  occupancy.grid.cells.resize(reader.readCount(1));
  for (std::int8_t& cell : occupancy.grid.cells) cell = reader.read<std::int8_t>();
  return occupancy;
}

LandmarkLayer readLandmarks(BinaryReader& reader) {
  LandmarkLayer layer;
  layer.stamp_ns = reader.read<std::int64_t>();
  layer.landmarks.resize(readCountOf<WorldLandmark>(reader));
  for (WorldLandmark& landmark : layer.landmarks) {
    landmark.id = reader.read<std::uint32_t>();
    landmark.stamp_ns = reader.read<std::int64_t>();
    landmark.type = reader.readText();
    landmark.classifier = reader.readText();
    landmark.pose = readPose(reader);
    landmark.existence_log_odds = reader.read<double>();
  }
  layer.cross_covariances.resize(readCountOf<LandmarkCrossCovariance>(reader));
  for (LandmarkCrossCovariance& block : layer.cross_covariances) {
    block.first_id = reader.read<std::uint32_t>();
    block.second_id = reader.read<std::uint32_t>();
    block.covariance_m2 = reader.readMatrix<Eigen::Matrix3d>();
  }
  return layer;
}

ColoredCloud readCloud(BinaryReader& reader) {
  ColoredCloud cloud;
  cloud.stamp_ns = reader.read<std::int64_t>();
  cloud.frame = reader.readText();
  cloud.map_from_frame = readPose(reader);
  cloud.points.resize(readCountOf<ColoredPoint>(reader));
  for (ColoredPoint& point : cloud.points) {
    point.x_m = reader.read<float>();
    point.y_m = reader.read<float>();
    point.z_m = reader.read<float>();
    point.rgb = reader.read<std::uint32_t>();
  }
  return cloud;
}

Trajectory readTrajectory(BinaryReader& reader) {
  Trajectory trajectory(readCountOf<StampedPose2>(reader));
  for (StampedPose2& pose : trajectory) {
    pose.stamp_ns = reader.read<std::int64_t>();
    pose.pose = readPose2(reader);
  }
  return trajectory;
}

LaserScan readScan(BinaryReader& reader) {
  LaserScan scan;
  scan.stamp_ns = reader.read<std::int64_t>();
  scan.angle_min_rad = reader.read<double>();
  scan.angle_increment_rad = reader.read<double>();
  scan.time_increment_s = reader.read<double>();
  scan.range_min_m = reader.read<float>();
  scan.range_max_m = reader.read<float>();
  scan.ranges_m.resize(reader.readCount(sizeof(float)));
  for (float& range_m : scan.ranges_m) range_m = reader.read<float>();
  return scan;
}

std::vector<PlacedScan> readScans(BinaryReader& reader) {
  std::vector<PlacedScan> scans(readCountOf<PlacedScan>(reader));
  for (PlacedScan& placed : scans) {
    placed.scan = readScan(reader);
    placed.base_from_laser = readPose2(reader);
    placed.map_from_laser = readPose2(reader);
    placed.last_beam = readPose2(reader);
  }
  return scans;
}

/// Checks the header; the reader stands at the content afterwards. \return the version
std::uint32_t checkHeader(const std::string& bytes, BinaryReader& reader) {
  if (bytes.compare(0, kMagic.size(), kMagic) != 0)
    throw std::runtime_error("it is not a world map");
  const auto version = reader.read<std::uint32_t>();
  if (version != kVersion && version != kVersionWithoutScans) {
    throw std::runtime_error("its format is version " + std::to_string(version) + ", not " +
                             std::to_string(kVersion));
  }
  const auto size = reader.read<std::uint64_t>();
  const auto expected_checksum = reader.read<std::uint64_t>();
  if (size != bytes.size() - reader.position())
    throw std::runtime_error("it is cut short or has something behind its end");
  if (expected_checksum != checksum(bytes, reader.position()))
    throw std::runtime_error("it is damaged");
  return version;
}

}  // namespace

std::string toBytes(const WorldMap& map) {
  BinaryWriter content;
  content.write(static_cast<std::uint64_t>(map.occupancies().size()));
  for (const auto& entry : map.occupancies()) write(content, *entry.second);
  write(content, map.landmarks());
  content.write(static_cast<std::uint64_t>(map.clouds().size()));
  for (const auto& entry : map.clouds()) write(content, *entry.second);
  write(content, map.trajectory());
  content.write(static_cast<std::uint64_t>(map.scans().size()));
  for (const PlacedScan& placed : map.scans()) write(content, placed);

  BinaryWriter header;
  header.write(kVersion);
  header.write(static_cast<std::uint64_t>(content.bytes().size()));
  header.write(checksum(content.bytes(), 0));
  return kMagic + header.bytes() + content.bytes();
}

WorldMap worldMapFromBytes(const std::string& bytes) {
  BinaryReader reader(bytes, std::min(bytes.size(), kMagic.size()));
  const std::uint32_t version = checkHeader(bytes, reader);
  try {
    WorldMap map;
    for (std::size_t left = readCountOf<LocalOccupancy>(reader); left > 0; --left)
      map.put(readOccupancy(reader));
    map.put(readLandmarks(reader));
    for (std::size_t left = readCountOf<ColoredCloud>(reader); left > 0; --left)
      map.put(readCloud(reader));
    map.put(readTrajectory(reader));
    if (version != kVersionWithoutScans) map.put(readScans(reader));
    if (!reader.atEnd()) throw std::runtime_error("it has something behind its end");
    return map;
  } catch (const std::logic_error& error) {  // what WorldMap refuses
    throw std::runtime_error(std::string("its content is wrong: ") + error.what());
  }
}

}  // namespace ram_slam
