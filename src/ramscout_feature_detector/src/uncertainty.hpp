// SPDX-License-Identifier: BSD-3-Clause
// What corners and edges share about their uncertainty.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

namespace ramscout_feature_detector {

inline double square(double x) {
  return x * x;
}

/// Variance of the position of a bound between two beams that hit `spacing_m` apart.
inline double samplingVariance(double spacing_m) {
  return square(spacing_m) / 12.0;
}

/// Variance along the longest axis of a covariance.
inline double largestVariance(const Eigen::Matrix2d& covariance) {
  const double mean = 0.5 * covariance.trace();
  return mean + std::sqrt(std::max(mean * mean - covariance.determinant(), 0.0));
}

}  // namespace ramscout_feature_detector
