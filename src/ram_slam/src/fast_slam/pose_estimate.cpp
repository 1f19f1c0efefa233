// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/pose_estimate.hpp"

#include <algorithm>

#include "ram_slam/fast_slam/resampling.hpp"

namespace ram_slam {
namespace {

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, wrapAngle(a.yaw_rad - b.yaw_rad)};
}

}  // namespace

Pose2 samplePose(const PoseWithCovariance2& from, Random random) {
  if (from.covariance.isZero(0.0)) return from.pose;
  const Eigen::Vector3d noise = random.gaussian(from.covariance);
  return {from.pose.x_m + noise.x(), from.pose.y_m + noise.y(),
          wrapAngle(from.pose.yaw_rad + noise.z())};
}

std::vector<double> weightsOf(const std::vector<Particle>& particles) {
  std::vector<double> log_weights;
  log_weights.reserve(particles.size());
  for (const Particle& particle : particles) log_weights.push_back(particle.log_weight);
  return normalisedWeights(log_weights);
}

std::size_t largest(const std::vector<double>& weights) {
  return static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) -
                                  weights.begin());
}

PoseWithCovariance2 estimatePose(const std::vector<Particle>& particles,
                                 const std::vector<double>& weights) {
  const Pose2& reference = particles[largest(weights)].proposal.pose;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    mean += weights[i] * difference(particles[i].proposal.pose, reference);
  }
  PoseWithCovariance2 estimate;
  estimate.pose = {reference.x_m + mean.x(), reference.y_m + mean.y(),
                   wrapAngle(reference.yaw_rad + mean.z())};
  Eigen::Matrix3d within = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d between = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Eigen::Vector3d deviation = difference(particles[i].proposal.pose, estimate.pose);
    within += weights[i] * particles[i].proposal.covariance;
    between += weights[i] * deviation * deviation.transpose();
  }
  // A sample's own mean is nearer to it than the true mean is: the weighted form of n / (n - 1).
  const double effective = effectiveCount(weights);
  if (effective > 1.0 + 1e-9) between *= effective / (effective - 1.0);
  estimate.covariance = within + between;
  return estimate;
}

}  // namespace ram_slam
