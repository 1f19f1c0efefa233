// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/random.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace ram_slam {
namespace {

std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// 2^64 divided by the golden ratio: the increment of SplitMix64.
constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t first_index, std::uint64_t second_index)
    : state_(mix(mix(mix(seed + kGolden) + first_index + kGolden) + second_index + kGolden)) {}

Random::result_type Random::operator()() {
  return mix(state_ += kGolden);
}

double Random::uniform() {
  return static_cast<double>((*this)() >> 11) * 0x1.0p-53;
}

double Random::gaussian() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * M_PI * uniform());
}

Eigen::Vector3d Random::gaussian(const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d standard(gaussian(), gaussian(), gaussian());
  const auto ldlt = covariance.ldlt();
  const Eigen::Vector3d scaled = ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().cwiseProduct(standard);
  const Eigen::Vector3d permuted = ldlt.matrixL() * scaled;
  return ldlt.transpositionsP().transpose() * permuted;
}

}  // namespace ram_slam
