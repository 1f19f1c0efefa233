// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/odometry_review.hpp"

#include <algorithm>
#include <cmath>

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

/// Less than an encoder's step of a small robot: such odometry does not move.
constexpr double kLeastMotion = 1e-6;  // m, rad, or per second

bool moves(const Pose2& motion) {
  return motion.translation().norm() > kLeastMotion || std::abs(motion.yaw_rad) > kLeastMotion;
}

}  // namespace

OdometryContent reviewOdometry(const std::vector<OdometryReading>& readings) {
  const auto pose_moves = [&](const OdometryReading& reading) {
    return moves(readings.front().odom_from_child.inverse() * reading.odom_from_child);
  };
  if (std::any_of(readings.begin(), readings.end(), pose_moves)) return OdometryContent::kPose;
  const auto twist_moves = [](const OdometryReading& reading) { return moves(reading.twist); };
  return std::any_of(readings.begin(), readings.end(), twist_moves) ? OdometryContent::kTwist
                                                                    : OdometryContent::kNothing;
}

void integrateTwist(std::vector<OdometryReading>& readings) {
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const OdometryReading& last = readings[i - 1];
    const double step_s = 1e-9 * static_cast<double>(readings[i].stamp_ns - last.stamp_ns);
    const Eigen::Vector3d twist{last.twist.x_m, last.twist.y_m, last.twist.yaw_rad};
    readings[i].odom_from_child = last.odom_from_child * ram_slam::exponential(step_s * twist);
  }
}

}  // namespace ramscout_bringup
