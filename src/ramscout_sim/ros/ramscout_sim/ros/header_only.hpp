// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

namespace ramscout_sim_ros {

/// Subscribes to a message of any type whose first field is a std_msgs/Header, and reads nothing
/// but that.
struct HeaderOnly {
  std_msgs::Header header;
};

}  // namespace ramscout_sim_ros

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<ramscout_sim_ros::HeaderOnly> {
  static const char* value() { return "*"; }
  static const char* value(const ramscout_sim_ros::HeaderOnly&) { return value(); }
};

template <>
struct DataType<ramscout_sim_ros::HeaderOnly> {
  static const char* value() { return "*"; }
  static const char* value(const ramscout_sim_ros::HeaderOnly&) { return value(); }
};

template <>
struct Definition<ramscout_sim_ros::HeaderOnly> {
  static const char* value() { return ""; }
  static const char* value(const ramscout_sim_ros::HeaderOnly&) { return value(); }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<ramscout_sim_ros::HeaderOnly> {
  template <typename Stream>
  static void read(Stream& stream, ramscout_sim_ros::HeaderOnly& message) {
    stream.next(message.header);
  }
};

}  // namespace serialization
}  // namespace ros
