// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <tf2_ros/buffer.h>

#include "ram_slam/stages/causes.hpp"

namespace ram_slam_ros {

/// Asks the master who publishes each of these inputs, and where else their types are published.
/// Without an answer nothing is changed.
void lookAtMaster(std::vector<ram_slam::InputFacts>& inputs);

/// Looks in tf for a transform: whether it is there now, how old it is, and which frames are above
/// the child and below the parent. Sets missing_s to 1 if it is missing, else to 0.
void lookAtTf(const tf2_ros::Buffer& buffer, ram_slam::TransformFacts& transform);

}  // namespace ram_slam_ros
