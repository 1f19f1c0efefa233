// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"

namespace ramscout_bringup {

/// One message of odometry: pose and twist, as nav_msgs/Odometry has them.
struct OdometryReading {
  std::int64_t stamp_ns = 0;
  ram_slam::Pose2 odom_from_child;
  ram_slam::Pose2 twist;  ///< in the child's frame [m/s, m/s, rad/s]
};

/// Where the motion in a row of odometry stands.
enum class OdometryContent {
  kPose,     ///< the poses move
  kTwist,    ///< the poses never move, the twist is not zero
  kNothing,  ///< neither moves
};

/// \param readings  by rising stamps
OdometryContent reviewOdometry(const std::vector<OdometryReading>& readings);

/// Replaces the poses by the integral of the twist, which is constant from one reading to the next.
/// \param readings  by rising stamps
void integrateTwist(std::vector<OdometryReading>& readings);

}  // namespace ramscout_bringup
