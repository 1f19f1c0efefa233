// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/landmark.hpp"

namespace ram_slam {

/// The six poses x +- sqrt(3) L e_i, L L^T = P, that have the mean and the covariance of a normal
/// distribution, each with the weight 1/6: the unscented transform with kappa = 0, or cubature
/// points (Arasaratnam and Haykin, IEEE TAC 54(6), 2009).
std::vector<Pose2> sigmaPoints(const PoseWithCovariance2& pose);

/// Mean and covariance of poses of equal weight; the mean of the yaw is that of its directions.
PoseWithCovariance2 momentsOf(const std::vector<Pose2>& poses);

/// A landmark of the map, and where it was seen in the base frame.
struct MapSighting {
  Landmark landmark;
  PointMeasurement measured;
};

/// The pose after all sightings at once, each sigma point expecting its own measurements (Julier
/// and Uhlmann, Proc. IEEE 92(3), 2004). \param cross_m2  covariance between the landmarks, 2n x
/// 2n, of which the blocks on the diagonal do not count
PoseWithCovariance2 correctedBy(const PoseWithCovariance2& pose,
                                const std::vector<MapSighting>& sightings,
                                const Eigen::MatrixXd& cross_m2);

}  // namespace ram_slam
