// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ramscout_sim {

/// What a random number is for. Each purpose has numbers of its own.
enum class Stream : std::uint64_t {
  kRange = 1,
  kLidarBias,
  kSlip,
  kOutlier,
  kBuilding,
  kDropout,
  kGlass
};

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

/// Normal numbers with mean 0 and variance 1, made many at once. Number i depends on `key` and i
/// alone. They reach to 6.6 standard deviations.
///
/// Philox 4x32-10 (Salmon et al., SC 2011) and Box-Muller with polynomials for logarithm, sine and
/// cosine that are exact to 1e-7 (Moshier's Cephes library). \param key  where its own numbers
/// begin
std::vector<float> gaussians(Random key, std::size_t count);

/// One block of Philox 4x32-10, as its authors publish known answers for it.
std::array<std::uint32_t, 4> philox(const std::array<std::uint32_t, 4>& counter,
                                    const std::array<std::uint32_t, 2>& key);

}  // namespace ramscout_sim
