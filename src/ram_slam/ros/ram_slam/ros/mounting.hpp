// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/Transform.h>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam_ros {

/// How a planar sensor sits on the robot.
struct Mounting {
  ram_slam::Pose2 base_from_sensor;
  bool upside_down = false;  ///< its readings must be mirrored (ram_slam::mirrored)
};

/// The planar mounting that a transform from the sensor's to the base's frame describes.
/// \throws std::invalid_argument if the sensor is tilted by more than 10 degrees from the
/// horizontal, upright or upside
///         down, or the transform is not finite
Mounting toMounting(const geometry_msgs::Transform& base_from_sensor);

}  // namespace ram_slam_ros
