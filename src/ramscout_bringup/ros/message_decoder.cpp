// SPDX-License-Identifier: BSD-3-Clause
// ROS 2 messages as the OMG's Common Data Representation writes them (formal/02-06-51), read by
// Fast CDR; the fields in the order of their definitions.
#include "message_decoder.hpp"

#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>
#include <ros/serialization.h>

namespace ramscout_bringup_ros {
namespace {

using eprosima::fastcdr::Cdr;

constexpr const char* kScan = "sensor_msgs/LaserScan";
constexpr const char* kEchoes = "sensor_msgs/MultiEchoLaserScan";
constexpr const char* kOdometry = "nav_msgs/Odometry";
constexpr const char* kTransforms = "tf2_msgs/TFMessage";

void read(Cdr& cdr, std_msgs::Header& header) {
  std::int32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  cdr >> seconds >> nanoseconds >> header.frame_id;
  if (seconds < 0 || nanoseconds >= 1'000'000'000U)
    throw std::runtime_error("a stamp that is no time");
  header.stamp = ros::Time(static_cast<std::uint32_t>(seconds), nanoseconds);
}

void read(Cdr& cdr, sensor_msgs::LaserScan& scan) {
  read(cdr, scan.header);
  cdr >> scan.angle_min >> scan.angle_max >> scan.angle_increment >> scan.time_increment >>
      scan.scan_time >> scan.range_min >> scan.range_max >> scan.ranges;
}

void read(Cdr& cdr, sensor_msgs::MultiEchoLaserScan& scan) {
  read(cdr, scan.header);
  cdr >> scan.angle_min >> scan.angle_max >> scan.angle_increment >> scan.time_increment >>
      scan.scan_time >> scan.range_min >> scan.range_max;
  std::uint32_t count = 0;
  cdr >> count;
  constexpr std::uint32_t kMaxBeams = 20000;
  if (count > kMaxBeams) throw std::runtime_error(std::to_string(count) + " beams");
  scan.ranges.resize(count);
  for (sensor_msgs::LaserEcho& beam : scan.ranges) cdr >> beam.echoes;
}

template <typename Vector>
void readVector(Cdr& cdr, Vector& vector) {
  cdr >> vector.x >> vector.y >> vector.z;
}

void read(Cdr& cdr, geometry_msgs::Quaternion& q) {
  cdr >> q.x >> q.y >> q.z >> q.w;
}

void read(Cdr& cdr, nav_msgs::Odometry& odometry) {
  read(cdr, odometry.header);
  cdr >> odometry.child_frame_id;
  readVector(cdr, odometry.pose.pose.position);
  read(cdr, odometry.pose.pose.orientation);
  for (double& value : odometry.pose.covariance) cdr >> value;
  readVector(cdr, odometry.twist.twist.linear);
  readVector(cdr, odometry.twist.twist.angular);
}

void read(Cdr& cdr, tf2_msgs::TFMessage& message) {
  std::uint32_t count = 0;
  cdr >> count;
  constexpr std::uint32_t kMaxTransforms = 10000;
  if (count > kMaxTransforms) throw std::runtime_error(std::to_string(count) + " transforms");
  message.transforms.resize(count);
  for (geometry_msgs::TransformStamped& transform : message.transforms) {
    read(cdr, transform.header);
    cdr >> transform.child_frame_id;
    readVector(cdr, transform.transform.translation);
    read(cdr, transform.transform.rotation);
  }
}

/// Walks over a message as ROS 1 writes it: packed, little-endian, lists behind their lengths.
class Ros1Walk {
public:
  Ros1Walk(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes), left_(size) {}

  void skip(std::size_t size) {
    if (size > left_) throw std::runtime_error("it is cut short");
    bytes_ += size;
    left_ -= size;
  }
  /// The length of a list whose elements have so many bytes at least: all of it must follow.
  std::size_t count(std::size_t element_bytes) {
    std::uint32_t count = 0;
    const std::uint8_t* at = bytes_;
    skip(sizeof(count));
    std::memcpy(&count, at, sizeof(count));
    if (count > left_ / element_bytes)
      throw std::runtime_error("it is too short for a list of " + std::to_string(count));
    return count;
  }
  void skipFloats() { skip(sizeof(float) * count(sizeof(float))); }
  /// Header and the seven numbers that all scans have.
  void skipScanHead() {
    skip(3 * sizeof(std::uint32_t));
    skip(count(1));
    skip(7 * sizeof(float));
  }

private:
  const std::uint8_t* bytes_;
  std::size_t left_;
};

// roscpp makes room for as many elements as a list states before it looks whether they follow: up
// to 16 GB for a message of a few bytes.
void requireLists(Ros1Walk walk, const sensor_msgs::LaserScan*) {
  walk.skipScanHead();
  walk.skipFloats();
  walk.skipFloats();
}

void requireLists(Ros1Walk walk, const sensor_msgs::MultiEchoLaserScan*) {
  walk.skipScanHead();
  for (int i = 0; i < 2; ++i) {
    for (std::size_t beams = walk.count(sizeof(std::uint32_t)); beams > 0; --beams)
      walk.skipFloats();
  }
}

void requireLists(Ros1Walk, const nav_msgs::Odometry*) {}  // it has none

void requireLists(Ros1Walk walk, const tf2_msgs::TFMessage*) {
  walk.count(5 * sizeof(std::uint32_t) +
             7 * sizeof(double));  // stamp, number, two names, transform
}

template <typename Message>
Message decodeAs(const std::string& encoding, const std::uint8_t* bytes, std::size_t size) {
  Message message;
  // Both readers take a pointer to non-const bytes, which they do not write to.
  auto* begin = const_cast<std::uint8_t*>(bytes);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  if (encoding == "ros1") {
    requireLists(Ros1Walk(bytes, size), &message);
    ros::serialization::IStream stream(begin, static_cast<std::uint32_t>(size));
    ros::serialization::deserialize(stream, message);
    return message;
  }
  eprosima::fastcdr::FastBuffer buffer(
      reinterpret_cast<char*>(begin),  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast)
      size);
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  cdr.read_encapsulation();
  read(cdr, message);
  return message;
}

}  // namespace

sensor_msgs::LaserScan firstEchoes(const sensor_msgs::MultiEchoLaserScan& message) {
  sensor_msgs::LaserScan scan;
  scan.header = message.header;
  scan.angle_min = message.angle_min;
  scan.angle_max = message.angle_max;
  scan.angle_increment = message.angle_increment;
  scan.time_increment = message.time_increment;
  scan.scan_time = message.scan_time;
  scan.range_min = message.range_min;
  scan.range_max = message.range_max;
  for (const sensor_msgs::LaserEcho& beam : message.ranges) {
    scan.ranges.push_back(beam.echoes.empty() ? std::numeric_limits<float>::infinity()
                                              : beam.echoes.front());
  }
  return scan;
}

std::string ros1TypeName(const std::string& type) {
  const std::size_t at = type.find("/msg/");
  const std::string name =
      at == std::string::npos ? type : type.substr(0, at) + type.substr(at + 4);
  return name == "tf/tfMessage" ? kTransforms : name;
}

MessageContent decode(const std::string& ros1_type,
                      const std::string& encoding,
                      const std::uint8_t* bytes,
                      std::size_t size) {
  if (encoding != "cdr" && encoding != "ros1")
    throw std::runtime_error("messages in the encoding '" + encoding + "' are not read");
  try {
    if (ros1_type == kScan) return decodeAs<sensor_msgs::LaserScan>(encoding, bytes, size);
    if (ros1_type == kEchoes)
      return firstEchoes(decodeAs<sensor_msgs::MultiEchoLaserScan>(encoding, bytes, size));
    if (ros1_type == kOdometry) return decodeAs<nav_msgs::Odometry>(encoding, bytes, size);
    if (ros1_type == kTransforms) return decodeAs<tf2_msgs::TFMessage>(encoding, bytes, size);
  } catch (const eprosima::fastcdr::exception::Exception& error) {
    throw std::runtime_error("a damaged " + ros1_type + ": " + error.what());
  } catch (const std::exception& error) {
    throw std::runtime_error("a damaged " + ros1_type + ": " + error.what());
  }
  throw std::runtime_error("messages of type " + ros1_type + " are not read");
}

}  // namespace ramscout_bringup_ros
