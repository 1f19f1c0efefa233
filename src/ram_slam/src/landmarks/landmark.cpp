// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/landmark.hpp"

#include <Eigen/LU>

namespace ram_slam {

double Innovation::squaredMahalanobis() const {
  return residual_m.dot(covariance_m2.inverse() * residual_m);
}

double Innovation::logLikelihood() const {
  return -0.5 * squaredMahalanobis() -
         0.5 * std::log(4.0 * M_PI * M_PI * covariance_m2.determinant());
}

Innovation innovation(const Pose2& map_from_base,
                      const Landmark& landmark,
                      const PointMeasurement& measured) {
  const Eigen::Matrix2d base_from_map = map_from_base.rotation().transpose();
  const Eigen::Vector2d expected_m =
      base_from_map * (landmark.mean_m - map_from_base.translation());
  Innovation result;
  result.residual_m = measured.position_m - expected_m;
  result.by_landmark = base_from_map;
  result.by_pose.leftCols<2>() = -base_from_map;
  result.by_pose.col(2) << expected_m.y(), -expected_m.x();
  result.covariance_m2 =
      base_from_map * landmark.covariance_m2 * base_from_map.transpose() + measured.covariance_m2;
  return result;
}

Innovation innovation(const PoseWithCovariance2& map_from_base,
                      const Landmark& landmark,
                      const PointMeasurement& measured) {
  Innovation result = innovation(map_from_base.pose, landmark, measured);
  result.covariance_m2 += result.by_pose * map_from_base.covariance * result.by_pose.transpose();
  return result;
}

PoseWithCovariance2 corrected(const PoseWithCovariance2& map_from_base,
                              const Innovation& innovation) {
  const Eigen::Matrix<double, 3, 2> gain = map_from_base.covariance *
                                           innovation.by_pose.transpose() *
                                           innovation.covariance_m2.inverse();
  const Eigen::Vector3d step = gain * innovation.residual_m;
  PoseWithCovariance2 result;
  result.pose = {map_from_base.pose.x_m + step.x(), map_from_base.pose.y_m + step.y(),
                 wrapAngle(map_from_base.pose.yaw_rad + step.z())};
  const Eigen::Matrix3d covariance =
      map_from_base.covariance - gain * innovation.covariance_m2 * gain.transpose();
  result.covariance = 0.5 * (covariance + covariance.transpose());
  return result;
}

Landmark updated(const Landmark& landmark,
                 const Innovation& innovation,
                 const PointMeasurement& measured) {
  const Eigen::Matrix2d gain = landmark.covariance_m2 * innovation.by_landmark.transpose() *
                               innovation.covariance_m2.inverse();
  const Eigen::Matrix2d kept = Eigen::Matrix2d::Identity() - gain * innovation.by_landmark;
  Landmark result;
  result.mean_m = landmark.mean_m + gain * innovation.residual_m;
  const Eigen::Matrix2d covariance = kept * landmark.covariance_m2 * kept.transpose() +
                                     gain * measured.covariance_m2 * gain.transpose();
  result.covariance_m2 = 0.5 * (covariance + covariance.transpose());
  return result;
}

Landmark createLandmark(const Pose2& map_from_base, const PointMeasurement& measured) {
  const Eigen::Matrix2d rotation = map_from_base.rotation();
  return {map_from_base * measured.position_m,
          rotation * measured.covariance_m2 * rotation.transpose()};
}

}  // namespace ram_slam
