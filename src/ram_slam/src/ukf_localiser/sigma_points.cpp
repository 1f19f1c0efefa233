// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ukf_localiser/sigma_points.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace ram_slam {
namespace {

/// x, y and yaw of each pose less those of another, one per column.
Eigen::Matrix3Xd deviations(const std::vector<Pose2>& poses, const Pose2& from) {
  Eigen::Matrix3Xd columns(3, static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i)
    columns.col(static_cast<Eigen::Index>(i)) = componentDifference(poses[i], from);
  return columns;
}

/// What each pose expects to measure, one column per pose.
Eigen::MatrixXd expected(const std::vector<Pose2>& poses,
                         const std::vector<MapSighting>& sightings) {
  Eigen::MatrixXd columns(2 * static_cast<Eigen::Index>(sightings.size()),
                          static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose2 base_from_map = poses[i].inverse();
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      columns.block<2, 1>(2 * static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) =
          base_from_map * sightings[k].landmark.mean_m;
    }
  }
  return columns;
}

}  // namespace

std::vector<Pose2> sigmaPoints(const PoseWithCovariance2& pose) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(pose.covariance);
  const Eigen::Matrix3d root =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  std::vector<Pose2> points;
  for (const double side : {1.0, -1.0}) {
    for (Eigen::Index i = 0; i < root.cols(); ++i) {
      const Eigen::Vector3d off = side * std::sqrt(3.0) * root.col(i);
      points.push_back({pose.pose.x_m + off.x(), pose.pose.y_m + off.y(),
                        wrapAngle(pose.pose.yaw_rad + off.z())});
    }
  }
  return points;
}

PoseWithCovariance2 momentsOf(const std::vector<Pose2>& poses) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const Pose2& pose : poses)
    sum += Eigen::Vector4d(pose.x_m, pose.y_m, std::cos(pose.yaw_rad), std::sin(pose.yaw_rad));
  const double weight = 1.0 / static_cast<double>(poses.size());
  PoseWithCovariance2 moments;
  moments.pose = {weight * sum[0], weight * sum[1], std::atan2(sum[3], sum[2])};
  const Eigen::Matrix3Xd off = deviations(poses, moments.pose);
  moments.covariance = weight * off * off.transpose();
  return moments;
}

PoseWithCovariance2 correctedBy(const PoseWithCovariance2& pose,
                                const std::vector<MapSighting>& sightings,
                                const Eigen::MatrixXd& cross_m2) {
  if (sightings.empty()) return pose;
  const std::vector<Pose2> points = sigmaPoints(pose);
  const double weight = 1.0 / static_cast<double>(points.size());
  const Eigen::Matrix3Xd off = deviations(points, pose.pose);
  Eigen::MatrixXd seen = expected(points, sightings);
  const Eigen::VectorXd mean = seen.rowwise().mean();
  seen.colwise() -= mean;
  const Eigen::Matrix2d base_from_map = pose.pose.rotation().transpose();
  Eigen::MatrixXd innovation = weight * seen * seen.transpose();
  Eigen::VectorXd residual(mean.size());
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(k);
    residual.segment<2>(row) = sightings[k].measured.position_m - mean.segment<2>(row);
    for (std::size_t l = 0; l < sightings.size(); ++l) {
      const Eigen::Index column = 2 * static_cast<Eigen::Index>(l);
      const Eigen::Matrix2d of_map = k == l ? sightings[k].landmark.covariance_m2
                                            : Eigen::Matrix2d(cross_m2.block<2, 2>(row, column));
      innovation.block<2, 2>(row, column) += base_from_map * of_map * base_from_map.transpose();
    }
    innovation.block<2, 2>(row, row) += sightings[k].measured.covariance_m2;
  }
  const Eigen::MatrixXd cross = weight * off * seen.transpose();
  const Eigen::LLT<Eigen::MatrixXd> factor(innovation);
  // Covariances between landmarks of which others are missing need not fit together.
  if (factor.info() != Eigen::Success && !cross_m2.isZero(0.0))
    return correctedBy(pose, sightings, Eigen::MatrixXd::Zero(cross_m2.rows(), cross_m2.cols()));
  const Eigen::MatrixXd u = factor.matrixL().solve(cross.transpose());  // K S K^T = u^T u
  const Eigen::Vector3d correction = u.transpose() * factor.matrixL().solve(residual);
  PoseWithCovariance2 corrected;
  corrected.pose = {pose.pose.x_m + correction.x(), pose.pose.y_m + correction.y(),
                    wrapAngle(pose.pose.yaw_rad + correction.z())};
  corrected.covariance = pose.covariance - u.transpose() * u;
  corrected.covariance = (0.5 * (corrected.covariance + corrected.covariance.transpose())).eval();
  return corrected;
}

}  // namespace ram_slam
