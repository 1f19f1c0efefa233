// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace ramscout_sim {

/// What a random number is for. Each purpose has numbers of its own.
enum class Stream : std::uint64_t { kRange = 1, kLidarBias, kSlip, kOutlier, kBuilding, kDropout };

/// Random numbers that depend on nothing but seed, purpose and index: not on the order in which
/// they are drawn, nor on the thread that draws them. SplitMix64 (Steele et al., OOPSLA 2014)
/// started at a hash of the three.
class Random {
public:
  Random(std::uint64_t seed, Stream stream, std::uint64_t index = 0);

  std::uint64_t bits();

  /// Uniform in [0, 1).
  double uniform();

  /// Uniform in [low, high).
  double uniform(double low, double high);

  /// Normal with mean 0 and variance 1.
  double gaussian();

private:
  std::uint64_t state_;
};

}  // namespace ramscout_sim
