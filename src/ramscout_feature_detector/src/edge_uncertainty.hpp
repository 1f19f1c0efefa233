// SPDX-License-Identifier: BSD-3-Clause
// What the fits of edges share about their uncertainty.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

#include "ramscout_feature_detector/contour.hpp"
#include "ramscout_feature_detector/edge.hpp"

namespace ramscout_feature_detector {

/// What a round or ragged edge leaves of the model (2 cm), and what straight legs do, such as
/// readings in steps of 1 mm (0.5 mm).
inline constexpr double kModelVarianceM2 = 4e-4;
inline constexpr double kStraightModelVarianceM2 = 2.5e-7;
inline constexpr double kOrientationModelVarianceRad2 = 1e-2;
inline constexpr double kStraightOrientationModelVarianceRad2 = 1e-5;

inline double square(double x) {
  return x * x;
}

/// Variance of the position of a bound between two beams that hit `spacing_m` apart.
inline double samplingVariance(double spacing_m) {
  return square(spacing_m) / 12.0;
}

inline Eigen::Vector2d normalOf(const LineFit& line) {
  return {-line.direction.y(), line.direction.x()};
}

/// Whether the longest axis of the covariance is within the limit.
inline bool isCertain(const Eigen::Matrix2d& covariance_m2,
                      const EdgeDetectorParameters& parameters) {
  const double mean = 0.5 * covariance_m2.trace();
  const double largest = mean + std::sqrt(std::max(mean * mean - covariance_m2.determinant(), 0.0));
  return largest <= square(parameters.position_sigma_limit);
}

}  // namespace ramscout_feature_detector
