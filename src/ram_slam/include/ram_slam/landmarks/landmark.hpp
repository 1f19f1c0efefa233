// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Identifies a landmark in a map; never used again for another one.
using LandmarkId = std::uint32_t;

/// One particle's belief about where one landmark is: a Gaussian in the map frame, given the
/// particle's path.
struct Landmark {
  Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();
};

/// A position measured in the base frame, with the covariance of its noise.
struct PointMeasurement {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();
};

/// The difference between a measurement and what was expected.
struct Innovation {
  Eigen::Vector2d residual_m = Eigen::Vector2d::Zero();         ///< measured - expected, base frame
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Identity();  ///< of the residual
  Eigen::Matrix<double, 2, 3> by_pose = decltype(by_pose)::Zero();  ///< d expected / d (x, y, yaw)
  Eigen::Matrix2d by_landmark = Eigen::Matrix2d::Identity();        ///< d expected / d landmark

  double squaredMahalanobis() const;
  /// ln N(residual; 0, covariance), a density per square metre.
  double logLikelihood() const;
};

/// For a pose that is known: expected = R^T (m - p), covariance R^T S_m R + R_z.
Innovation innovation(const Pose2& map_from_base,
                      const Landmark& landmark,
                      const PointMeasurement& measured);

/// For a pose with covariance: adds H_x P H_x^T.
Innovation innovation(const PoseWithCovariance2& map_from_base,
                      const Landmark& landmark,
                      const PointMeasurement& measured);

/// The pose after the measurement: x + K v, P - K H_x P with K = P H_x^T S^-1 (Montemerlo et al.,
/// IJCAI 2003, eq. 13-15 in the information form; this is the same by the matrix inversion lemma).
PoseWithCovariance2 corrected(const PoseWithCovariance2& map_from_base,
                              const Innovation& innovation);

/// The landmark after the measurement from a known pose: Kalman update in Joseph's form, symmetric
/// by construction.
Landmark updated(const Landmark& landmark,
                 const Innovation& innovation,
                 const PointMeasurement& measured);

/// The landmark that one measurement from a known pose makes: m = p + R z, covariance R R_z R^T.
Landmark createLandmark(const Pose2& map_from_base, const PointMeasurement& measured);

}  // namespace ram_slam
