// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Learns while driving what the wheels get wrong again and again: worn wheels, and unequal ones.
///
/// Of intervals of some decimetres without much turning the true motion is taken to be (r x, y,
/// yaw + c x), with (x, y, yaw) the logarithm of the wheels' motion: r is the ratio of distances, c
/// the turn per metre driven forward. Both are found by least squares over what was observed, older
/// intervals counting less, with a prior of r = 1, c = 0. A wrong ratio of turns is not learned:
/// what wheels say of turns is noisy, which would look like one.
class WheelBias {
public:
  /// The motion as it will have been, given what the wheels say.
  Pose2 corrected(const Pose2& wheels) const;

  /// Takes one interval: the motion that the wheels tell, and the one observed.
  void add(const Pose2& wheels, const Pose2& observed);

  double distanceRatio() const;
  double yawPerMetre() const;  ///< [rad/m]

private:
  double squares_m2_ = 0.0;          ///< sum of x^2
  double distance_errors_m2_ = 0.0;  ///< sum of x (observed x - x)
  double yaw_errors_rad_m_ = 0.0;    ///< sum of x (observed yaw - yaw)
};

}  // namespace ram_slam
