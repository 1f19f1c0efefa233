// SPDX-License-Identifier: BSD-3-Clause
// What single precision means for rays.
#pragma once

#include <cmath>
#include <limits>

namespace ramscout_sim {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Component of a direction whose inverse is used. Embree takes components below 1e-18 for positive
/// when it inverts them, but not when it sorts rays by sign; this is far above that, and moves the
/// end of a ray by a micrometre in 1000 km.
constexpr float kSmallest = 1e-12F;
/// Cosine of the incidence (89 degrees) below which ends of rays are computed in double precision:
/// single precision places a surface to a micrometre, which a grazing ray meets as millimetres.
constexpr float kGrazing = 0.02F;

[[gnu::always_inline]] inline float nonzero(float x) {
  return std::abs(x) < kSmallest ? kSmallest : x;
}

}  // namespace ramscout_sim
