// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "message_source.hpp"

namespace ramscout_bringup_ros {

using MessageContent = decltype(RecordedMessage::content);

/// The name that ROS 1 has for a type: without `msg/`.
std::string ros1TypeName(const std::string& type);

/// Whether decode() knows a type and an encoding (`cdr`: ROS 2, `ros1`).
bool isDecodable(const std::string& ros1_type, const std::string& encoding);

/// A message from its bytes. \param ros1_type  as ros1TypeName() gives it
/// \throws std::runtime_error if the bytes are not such a message
MessageContent decode(const std::string& ros1_type,
                      const std::string& encoding,
                      const std::uint8_t* bytes,
                      std::size_t size);

/// The first echo of each beam; +Inf where there is none.
template <typename MultiEchoLaserScan>
sensor_msgs::LaserScan firstEchoes(const MultiEchoLaserScan& message) {
  sensor_msgs::LaserScan scan;
  scan.header = message.header;
  scan.angle_min = message.angle_min;
  scan.angle_max = message.angle_max;
  scan.angle_increment = message.angle_increment;
  scan.time_increment = message.time_increment;
  scan.scan_time = message.scan_time;
  scan.range_min = message.range_min;
  scan.range_max = message.range_max;
  for (const auto& beam : message.ranges) {
    scan.ranges.push_back(beam.echoes.empty() ? std::numeric_limits<float>::infinity()
                                              : beam.echoes.front());
  }
  return scan;
}

}  // namespace ramscout_bringup_ros
