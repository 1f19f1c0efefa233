// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "ram_slam/pose_graph/pose_graph.hpp"

namespace ram_slam {

/// The error of an edge at two poses (x, y, yaw).
inline Eigen::Vector3d edgeError(const PoseEdge& edge, const double* from, const double* to) {
  const double c = std::cos(from[2]);
  const double s = std::sin(from[2]);
  const double dx = to[0] - from[0];
  const double dy = to[1] - from[1];
  return {c * dx + s * dy - edge.from_from_to.x_m, -s * dx + c * dy - edge.from_from_to.y_m,
          wrapAngle(to[2] - from[2] - edge.from_from_to.yaw_rad)};
}

/// The derivatives of edgeError() by the two poses.
struct EdgeJacobians {
  Eigen::Matrix3d by_from;
  Eigen::Matrix3d by_to;
};

inline EdgeJacobians edgeJacobians(const double* from, const double* to) {
  const double c = std::cos(from[2]);
  const double s = std::sin(from[2]);
  const double dx = to[0] - from[0];
  const double dy = to[1] - from[1];
  EdgeJacobians jacobians;
  jacobians.by_from << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy, 0.0, 0.0, -1.0;
  jacobians.by_to << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  return jacobians;
}

/// L^T with information = L L^T; also for singular information, of which a corridor's edges have
/// some.
inline Eigen::Matrix3d squareRoot(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace ram_slam
