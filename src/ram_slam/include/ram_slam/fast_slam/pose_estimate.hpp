// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/geometry/random.hpp"

namespace ram_slam {

/// A pose of that distribution; its mean if the covariance is zero.
Pose2 samplePose(const PoseWithCovariance2& from, Random random);

/// Weights proportional to exp(log_weight) with sum 1.
std::vector<double> weightsOf(const std::vector<Particle>& particles);

/// Index of the largest weight, the first of several; weights are not empty.
std::size_t largest(const std::vector<double>& weights);

/// Mean and covariance of the mixture of the particles' proposals: the mean of their covariances
/// plus the covariance of their means, unbiased for the effective number of particles.
/// \param weights  one per particle, of sum 1
PoseWithCovariance2 estimatePose(const std::vector<Particle>& particles,
                                 const std::vector<double>& weights);

}  // namespace ram_slam
