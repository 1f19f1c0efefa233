// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/shared_error.hpp"

#include <algorithm>

namespace ram_slam {
void SharedError::move(double distance_m, const Eigen::Vector2d& place_m) {
  new_ground_m_ =
      isKnown(place_m) ? 0.0 : std::min(new_ground_m_ + distance_m, parameters_.new_ground_m);
}

void SharedError::follow(const Trajectory& map_from_base) {
  known_m_.clear();
  for (const StampedPose2& stamped : map_from_base) {
    const Eigen::Vector2d place_m = stamped.pose.translation();
    if (known_m_.empty() || (place_m - known_m_.back()).norm() >= parameters_.known_spacing_m)
      known_m_.push_back(place_m);
  }
}

void SharedError::forget() {
  known_m_.clear();
  new_ground_m_ = parameters_.new_ground_m;
}

Eigen::Matrix3d SharedError::covariance(double floor_m) const {
  const double share = new_ground_m_ / parameters_.new_ground_m;
  const double variance_m2 = floor_m * floor_m *
                             (parameters_.known_floors * parameters_.known_floors +
                              share * (parameters_.new_floors * parameters_.new_floors -
                                       parameters_.known_floors * parameters_.known_floors));
  const double variance_rad2 =
      variance_m2 / (parameters_.feature_distance_m * parameters_.feature_distance_m);
  return Eigen::Vector3d(variance_m2, variance_m2, variance_rad2).asDiagonal();
}

bool SharedError::isKnown(const Eigen::Vector2d& place_m) const {
  return std::any_of(known_m_.begin(), known_m_.end(), [&](const Eigen::Vector2d& known_m) {
    return (known_m - place_m).squaredNorm() <
           parameters_.known_within_m * parameters_.known_within_m;
  });
}

}  // namespace ram_slam
