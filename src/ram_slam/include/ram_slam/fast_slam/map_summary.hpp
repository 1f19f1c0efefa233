// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"

namespace ram_slam {

/// The landmarks of one particle, each averaged over all particles that hold it (law of total
/// covariance): mean_i = sum_k w_k mean_i^k, Cov(i, j) = sum_k w_k (mean_i^k - mean_i)(mean_j^k -
/// mean_j)^T + [i = j] sum_k w_k Cov_i^k. Left out are those that were confirmed once and have been
/// overlooked so often since that they may be gone. Cross-covariances are
/// given between landmarks that are near each other and correlated. \param weights  one per
/// particle, of sum 1
LandmarkMap summarise(const LandmarkRegistry& registry,
                      const Particle& chosen,
                      const std::vector<Particle>& particles,
                      const std::vector<double>& weights,
                      const MapSummaryParameters& parameters);

}  // namespace ram_slam
