// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {

/// Weights proportional to exp(log_weights) with sum 1. If all are -infinity or any is NaN they
/// come out equal: then the weights carry no information. (An empty vector gives an empty one.)
std::vector<double> normalisedWeights(const std::vector<double>& log_weights);

/// 1 / sum of squares of weights that sum to 1: between 1 (one particle has it all) and their
/// number.
double effectiveCount(const std::vector<double>& weights);

/// Indices of the particles to keep, ascending, as many as there are weights, by low-variance
/// resampling.
///
/// One random number places n equally spaced arrows on the weight axis, so that a particle of
/// weight w is kept floor(n w) or ceil(n w) times (Thrun et al., Probabilistic Robotics, 2005,
/// table 4.4).
///
/// \param weights  non-negative; need not be normalised
/// \throws std::invalid_argument if the sum is not positive and finite, e.g. for no weights at all
std::vector<std::size_t> resampleLowVariance(const std::vector<double>& weights, Random& random);

}  // namespace ram_slam
