// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace ram_slam {

/// One feature as a detector saw it, in the robot's base frame: the planar part of
/// ram_slam_msgs/Feature.
struct Feature {
  std::string type;        ///< kind; selects the FeatureMatcher
  std::string classifier;  ///< semi-unique description, empty if none
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();  ///< of the position
  double orientation_rad = 0.0;
  double orientation_variance_rad2 = 1e6;  ///< 1e6: not observed
};

/// The features of one reading of one sensor.
struct FeatureList {
  std::int64_t stamp_ns = 0;
  std::vector<Feature> features;
};

}  // namespace ram_slam
