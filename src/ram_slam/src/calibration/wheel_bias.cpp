// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/wheel_bias.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {

const ram_parameters::ParameterTable<WheelBiasParameters>& WheelBiasParameters::table() {
  using namespace ram_parameters;
  using P = WheelBiasParameters;
  static const auto table =
      ParameterTable<P>()
          .include(&P::interval,
                   motionGateTable("Motion over which wheels and scans are compared."), "interval_")
          .add("max_interval_turn_rad", &P::max_interval_turn_rad, "rad", positive(),
               "Intervals with more turning are not used.")
          .add("memory_m", &P::memory_m, "m", positive(),
               "Driving so far makes older intervals count 1/e.")
          .add("prior_m2", &P::prior_m2, "m^2", positive(),
               "The prior counts as if no error had been observed over this sum of squared "
               "distances.")
          .add("max_distance_error", &P::max_distance_error, "", within(0.0, 1.0),
               "Greatest error of the wheels' distance, as a share of it.")
          .add("max_yaw_rad_per_m", &P::max_yaw_rad_per_m, "rad/m", atLeast(0.0),
               "Greatest error of the wheels' turn per metre.");
  return table;
}

double WheelBias::distanceRatio() const {
  return 1.0 + std::clamp(distance_errors_m2_ / (distance_squares_m2_ + parameters_.prior_m2),
                          -parameters_.max_distance_error, parameters_.max_distance_error);
}

double WheelBias::yawPerMetre() const {
  return std::clamp(yaw_errors_rad_m_ / (squares_m2_ + parameters_.prior_m2),
                    -parameters_.max_yaw_rad_per_m, parameters_.max_yaw_rad_per_m);
}

Pose2 WheelBias::corrected(const Pose2& wheels) const {
  const Eigen::Vector3d twist = logarithm(wheels);
  return exponential(
      {distanceRatio() * twist.x(), twist.y(), twist.z() + yawPerMetre() * twist.x()});
}

void WheelBias::add(const Pose2& wheels, const Pose2& observed, double distance_share) {
  const Eigen::Vector3d twist = logarithm(wheels);
  if (std::abs(twist.z()) > parameters_.max_interval_turn_rad) return;
  const Eigen::Vector3d error = logarithm(observed) - twist;
  const double kept = std::exp(-std::abs(twist.x()) / parameters_.memory_m);
  squares_m2_ = kept * squares_m2_ + twist.x() * twist.x();
  distance_squares_m2_ = kept * distance_squares_m2_ + distance_share * twist.x() * twist.x();
  distance_errors_m2_ = kept * distance_errors_m2_ + distance_share * twist.x() * error.x();
  yaw_errors_rad_m_ = kept * yaw_errors_rad_m_ + twist.x() * error.z();
}

}  // namespace ram_slam
