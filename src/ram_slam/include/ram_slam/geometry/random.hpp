// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include <Eigen/Core>

namespace ram_slam {

/// A stream of random numbers fixed by a seed and up to two indices (update and particle, for
/// example), so that the numbers a particle draws depend on nothing else: not on the thread, not on
/// what others drew before.
///
/// SplitMix64 (Steele et al., OOPSLA 2014) started at a hash of the key. A
/// UniformRandomBitGenerator.
class Random {
public:
  using result_type = std::uint64_t;

  explicit Random(std::uint64_t seed,
                  std::uint64_t first_index = 0,
                  std::uint64_t second_index = 0);

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()();

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform();

  /// Normal with mean 0 and variance 1 (Box-Muller, the cosine branch: no state between calls).
  double gaussian();

  /// Normal with mean 0 and the given covariance (symmetric, positive semi-definite).
  Eigen::Vector3d gaussian(const Eigen::Matrix3d& covariance);

private:
  std::uint64_t state_;
};

}  // namespace ram_slam
