// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Settings of WheelBias.
struct WheelBiasParameters {
  MotionGate interval{0.3, 0.3};       ///< motion over which the errors of the wheels are compared
  double max_interval_turn_rad = 0.2;  ///< intervals with more turning are not used
  double memory_m = 50.0;              ///< driving so far makes older intervals count 1/e
  /// The prior counts as if no error had been observed over this sum of squared distances.
  double prior_m2 = 0.3;
  double max_distance_error = 0.2;  ///< of the ratio of distances from 1, to either side
  double max_yaw_rad_per_m = 0.1;   ///< turn per metre, to either side

  static const ram_parameters::ParameterTable<WheelBiasParameters>& table();
};

/// Learns while driving what the wheels get wrong again and again: worn wheels, and unequal ones.
///
/// Of intervals of some decimetres without much turning the true motion is taken to be (r x, y,
/// yaw + c x), with (x, y, yaw) the logarithm of the wheels' motion: r is the ratio of distances, c
/// the turn per metre driven forward. Both are found by least squares over what was observed, older
/// intervals counting less, with a prior of r = 1, c = 0. A wrong ratio of turns is not learned:
/// the turns of wheels are noisy, and noise would be taken for one.
class WheelBias {
public:
  explicit WheelBias(const WheelBiasParameters& parameters = {}) : parameters_(parameters) {}

  /// The most likely motion, given that of the wheels.
  Pose2 corrected(const Pose2& wheels) const;

  /// Takes one interval: the motion of the wheels, and the one observed.
  /// \param distance_share  how much of the observed distance was measured without the wheels, in
  ///   [0, 1]: the rest only repeats what was learned before
  void add(const Pose2& wheels, const Pose2& observed, double distance_share = 1.0);

  double distanceRatio() const;
  double yawPerMetre() const;  ///< [rad/m]

private:
  WheelBiasParameters parameters_;
  double squares_m2_ = 0.0;           ///< sum of x^2
  double distance_squares_m2_ = 0.0;  ///< sum of x^2, each by its share
  double distance_errors_m2_ = 0.0;   ///< sum of x (observed x - x), each by its share
  double yaw_errors_rad_m_ = 0.0;     ///< sum of x (observed yaw - yaw)
};

}  // namespace ram_slam
