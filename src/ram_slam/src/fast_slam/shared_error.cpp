// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/shared_error.hpp"

#include <algorithm>

namespace ram_slam {
namespace {

constexpr double kFeatureDistance_m = 5.0;  // typical: turns errors of features into errors of yaw
// Standard deviations in floors, chosen on simulated tours: on known ground, and after so much new
// ground.
constexpr double kLeast = 0.5;
constexpr double kMost = 2.0;
constexpr double kMostAfter_m = 50.0;
constexpr double kKnownWithin_m = 2.0;
constexpr double kKnownEvery_m = 1.0;

}  // namespace

void SharedError::move(double distance_m, const Eigen::Vector2d& place_m) {
  new_ground_m_ = isKnown(place_m) ? 0.0 : std::min(new_ground_m_ + distance_m, kMostAfter_m);
}

void SharedError::follow(const Trajectory& map_from_base) {
  known_m_.clear();
  for (const StampedPose2& stamped : map_from_base) {
    const Eigen::Vector2d place_m = stamped.pose.translation();
    if (known_m_.empty() || (place_m - known_m_.back()).norm() >= kKnownEvery_m)
      known_m_.push_back(place_m);
  }
}

void SharedError::forget() {
  known_m_.clear();
  new_ground_m_ = kMostAfter_m;
}

Eigen::Matrix3d SharedError::covariance(double floor_m) const {
  const double share = new_ground_m_ / kMostAfter_m;
  const double variance_m2 =
      floor_m * floor_m * (kLeast * kLeast + share * (kMost * kMost - kLeast * kLeast));
  const double variance_rad2 = variance_m2 / (kFeatureDistance_m * kFeatureDistance_m);
  return Eigen::Vector3d(variance_m2, variance_m2, variance_rad2).asDiagonal();
}

bool SharedError::isKnown(const Eigen::Vector2d& place_m) const {
  return std::any_of(known_m_.begin(), known_m_.end(), [&](const Eigen::Vector2d& known_m) {
    return (known_m - place_m).squaredNorm() < kKnownWithin_m * kKnownWithin_m;
  });
}

}  // namespace ram_slam
