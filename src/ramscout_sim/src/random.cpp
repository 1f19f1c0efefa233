// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/random.hpp"

#include <cmath>

namespace ramscout_sim {
namespace {

// SplitMix64 (Steele, Lea, Flood, 2014): 2^64 over the golden ratio, made odd.
constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, Stream stream, std::uint64_t index)
    : state_(mix(mix(mix(seed + kGolden) + static_cast<std::uint64_t>(stream) * kGolden) + index)) {
}

std::uint64_t Random::bits() {
  return mix(state_ += kGolden);
}

double Random::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

double Random::uniform(double low, double high) {
  return low + (high - low) * uniform();
}

// Box-Muller, the cosine branch only, so that no number is kept between calls.
double Random::gaussian() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * M_PI * uniform());
}

}  // namespace ramscout_sim
