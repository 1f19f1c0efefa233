// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {

/// What the errors of features have in common, so that no number of them makes it smaller.
///
/// They are alike from scan to scan, and on new ground they add up: landmarks there are placed from
/// poses that others gave, often from afar. So the variance they leave in the pose grows with the
/// way, from a quarter of a floor's to four times that after 50 m of new ground. Known is the start
/// and where the robot came along a trajectory that a smoother has corrected: that goes by scans.
class SharedError {
public:
  explicit SharedError(const SharedErrorParameters& parameters = {}) : parameters_(parameters) {}

  /// The robot drove so far [m], >= 0, to `place_m` of the map.
  void move(double distance_m, const Eigen::Vector2d& place_m);
  /// The map was bent along this trajectory, given in the map: known ground from now on.
  void follow(const Trajectory& map_from_base);
  /// The map was learned elsewhere, how is not known: all ground is new.
  void forget();

  /// Of the pose, in x, y and yaw; yaw as if all features were 5 m away.
  /// \param floor_m  standard deviation that the errors of features have in common
  Eigen::Matrix3d covariance(double floor_m) const;

private:
  bool isKnown(const Eigen::Vector2d& place_m) const;

  SharedErrorParameters parameters_;
  std::vector<Eigen::Vector2d> known_m_;  ///< places along the corrected trajectory
  double new_ground_m_ = 0.0;             ///< the way since the robot was on known ground
};

}  // namespace ram_slam
