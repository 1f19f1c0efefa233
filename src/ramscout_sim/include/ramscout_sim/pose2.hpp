// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace ramscout_sim {

/// A pose on the floor, or the transform `target_from_source` it stands for.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// The same angle in (-pi, pi].
double wrapAngle(double angle_rad);

/// `a_from_c = a_from_b * b_from_c`; the yaw is wrapped.
Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c);

Eigen::Isometry3d toIsometry(const Pose2& pose);

/// Position and heading of a body that may be tilted: the direction of its x axis seen from above.
Pose2 toPose2(const Eigen::Isometry3d& pose);

/// Speed on the floor in the robot's own axes (x forward, y left).
struct Twist2 {
  double forward_mps = 0.0;
  double left_mps = 0.0;
  double turn_radps = 0.0;
};

}  // namespace ramscout_sim
