// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include "ram_slam/fast_slam/fast_slam.hpp"

#include "synthetic_world.hpp"

namespace ram_slam {

inline SyntheticDrive office(std::uint64_t seed, const SyntheticNoise& noise = {}) {
  return syntheticDrive(rectangleTour(16.0, 8.0, 2),
                        scatteredLandmarks({-4.0, -4.0}, {22.0, 15.0}, 60, 1.0, seed), 6.0, noise,
                        seed);
}

struct Errors {
  double position_m = 0.0;  ///< root mean square
  double yaw_rad = 0.0;
  double final_m = 0.0;
};

inline Errors errorsOf(const std::vector<StampedPose2>& trajectory,
                       const std::vector<Pose2>& truth) {
  Errors errors;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Pose2 error = truth[i].inverse() * trajectory[i].pose;
    errors.position_m += error.translation().squaredNorm();
    errors.yaw_rad += error.yaw_rad * error.yaw_rad;
    errors.final_m = error.translation().norm();
  }
  errors.position_m = std::sqrt(errors.position_m / static_cast<double>(trajectory.size()));
  errors.yaw_rad = std::sqrt(errors.yaw_rad / static_cast<double>(trajectory.size()));
  return errors;
}

inline FastSlam run(const SyntheticDrive& drive, const FastSlamParameters& parameters) {
  FastSlam filter(parameters);
  for (const FeatureList& list : drive.lists) filter.update(list, drive.odometry);
  return filter;
}

inline FeatureList oneFeature(std::int64_t stamp_ns,
                              const Eigen::Vector2d& position_m,
                              double variance_m2) {
  FeatureList list;
  list.stamp_ns = stamp_ns;
  list.features.resize(1);
  list.features[0].type = "pole";
  list.features[0].position_m = position_m;
  list.features[0].covariance_m2 = variance_m2 * Eigen::Matrix2d::Identity();
  return list;
}

inline std::string bytesOf(const FastSlam& filter) {
  std::string bytes;
  const auto append = [&bytes](double value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const Particle& particle : filter.particles()) {
    for (const Pose2& pose : {particle.map_from_base, particle.proposal.pose}) {
      append(pose.x_m);
      append(pose.y_m);
      append(pose.yaw_rad);
    }
    append(particle.log_weight);
    particle.landmarks.forEach([&](LandmarkId id, const Landmark& landmark) {
      append(id);
      for (int i = 0; i < 2; ++i) append(landmark.mean_m[i]);
      for (int i = 0; i < 4; ++i) append(landmark.covariance_m2(i / 2, i % 2));
    });
  }
  for (int i = 0; i < 9; ++i) append(filter.estimate().covariance(i / 3, i % 3));
  return bytes;
}

/// Every update counts, every landmark counts at once, nothing is added to the detector's
/// covariance nor to the motion's.
inline FastSlamParameters plain() {
  FastSlamParameters parameters;
  parameters.update_distance = parameters.update_angle = 0.0;
  parameters.confirm_log_odds = -1.0;
  parameters.feature_noise_floor = 0.0;
  parameters.pose_noise_floor = 0.0;
  return parameters;
}

}  // namespace ram_slam
