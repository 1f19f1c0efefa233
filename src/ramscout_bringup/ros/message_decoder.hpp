// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include <sensor_msgs/MultiEchoLaserScan.h>

#include "message_source.hpp"

namespace ramscout_bringup_ros {

using MessageContent = decltype(RecordedMessage::content);

/// The name that ROS 1 has for a type: without `msg/`.
std::string ros1TypeName(const std::string& type);

/// A message from its bytes. \param ros1_type  as ros1TypeName() gives it \param encoding  `cdr`
/// (ROS 2) or `ros1`
/// \throws std::runtime_error if the bytes are not such a message, or the encoding is another one
MessageContent decode(const std::string& ros1_type,
                      const std::string& encoding,
                      const std::uint8_t* bytes,
                      std::size_t size);

/// The first echo of each beam; +Inf where there is none.
sensor_msgs::LaserScan firstEchoes(const sensor_msgs::MultiEchoLaserScan& message);

}  // namespace ramscout_bringup_ros
