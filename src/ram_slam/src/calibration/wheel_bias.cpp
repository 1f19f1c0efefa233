// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/wheel_bias.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {
namespace {

constexpr double kMostTurn_rad = 0.2;  // of an interval
constexpr double kMemory_m = 50.0;     // driving so far makes older intervals count 1/e
// The prior, as if nothing wrong had been observed over that sum of squares [m^2].
constexpr double kPrior_m2 = 0.3;
// No robot that drives is worse.
constexpr double kMostDistanceError = 0.2;
constexpr double kMostYawPerMetre = 0.1;

}  // namespace

double WheelBias::distanceRatio() const {
  return 1.0 + std::clamp(distance_errors_m2_ / (squares_m2_ + kPrior_m2), -kMostDistanceError,
                          kMostDistanceError);
}

double WheelBias::yawPerMetre() const {
  return std::clamp(yaw_errors_rad_m_ / (squares_m2_ + kPrior_m2), -kMostYawPerMetre,
                    kMostYawPerMetre);
}

Pose2 WheelBias::corrected(const Pose2& wheels) const {
  const Eigen::Vector3d told = logarithm(wheels);
  return exponential({distanceRatio() * told.x(), told.y(), told.z() + yawPerMetre() * told.x()});
}

void WheelBias::add(const Pose2& wheels, const Pose2& observed) {
  const Eigen::Vector3d told = logarithm(wheels);
  if (std::abs(told.z()) > kMostTurn_rad) return;
  const Eigen::Vector3d error = logarithm(observed) - told;
  const double kept = std::exp(-std::abs(told.x()) / kMemory_m);
  squares_m2_ = kept * squares_m2_ + told.x() * told.x();
  distance_errors_m2_ = kept * distance_errors_m2_ + told.x() * error.x();
  yaw_errors_rad_m_ = kept * yaw_errors_rad_m_ + told.x() * error.z();
}

}  // namespace ram_slam
