// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace ram_slam {

std::vector<double> normalisedWeights(const std::vector<double>& log_weights) {
  if (log_weights.empty()) return {};
  const double largest = *std::max_element(log_weights.begin(), log_weights.end());
  std::vector<double> weights(log_weights.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = std::exp(log_weights[i] - largest);
    sum += weights[i];
  }
  if (!std::isfinite(sum)) {
    std::fill(weights.begin(), weights.end(), 1.0);
    sum = static_cast<double>(weights.size());
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double effectiveCount(const std::vector<double>& weights) {
  double sum_of_squares = 0.0;
  for (const double weight : weights) sum_of_squares += weight * weight;
  return 1.0 / sum_of_squares;
}

std::vector<std::size_t> resampleLowVariance(const std::vector<double>& weights, Random& random) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0.0) || !std::isfinite(sum)) {
    throw std::invalid_argument("weights to resample must have a positive, finite sum, got " +
                                std::to_string(sum));
  }
  const double spacing = sum / static_cast<double>(weights.size());
  const double first = random.uniform() * spacing;
  std::vector<std::size_t> kept;
  kept.reserve(weights.size());
  std::size_t i = 0;
  double upper = weights[0];
  for (std::size_t arrow = 0; arrow < weights.size(); ++arrow) {
    const double place = first + static_cast<double>(arrow) * spacing;
    // The last particle takes what rounding leaves over.
    while (place >= upper && i + 1 < weights.size()) upper += weights[++i];
    kept.push_back(i);
  }
  return kept;
}

}  // namespace ram_slam
