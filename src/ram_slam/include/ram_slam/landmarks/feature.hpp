// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"

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
  std::int64_t delay_ns = 0;  ///< seen so long after the list's stamp, in the base frame of then
};

/// A larger variance of an orientation means that it was not observed.
constexpr double kUnobservedOrientation_rad2 = 1.0;

/// How much likelier [nat] it is that two orientations are of one thing than that they have nothing
/// to do with each other. 0 if the variance exceeds 1 rad^2: then one of them was not observed.
/// \param variance_rad2  of their difference
/// \param wrong_share  of things whose orientation is not seen as it is, in [0, 1)
double orientationLogRatio(double difference_rad, double variance_rad2, double wrong_share);

/// The features of one reading of one sensor.
struct FeatureList {
  std::int64_t stamp_ns = 0;
  std::vector<Feature> features;
};

/// The features as they would have been seen at the list's stamp, all at once: a lidar that sweeps
/// sees each at another time.
/// \param motion  of the robot over the interval up to the stamp, assumed to continue unchanged;
/// without effect if the interval is not positive or longer than 1 s
FeatureList deskew(FeatureList list, const Pose2& motion, std::int64_t interval_ns);

}  // namespace ram_slam
