// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>

namespace ramscout_feature_detector {

/// A table at distances of 0, 0.02, ... between two grids, linear in between, its last value
/// beyond.
template <std::size_t kCount>
double ratioAt(double distance, const std::array<double, kCount>& ratios) {
  constexpr double kStep = 0.02;
  const double place = distance / kStep;
  const auto before = std::min(static_cast<std::size_t>(place), kCount - 1);
  const auto after = std::min(before + 1, kCount - 1);
  const double fraction = place - static_cast<double>(before);
  return ratios[before] + fraction * (ratios[after] - ratios[before]);
}

}  // namespace ramscout_feature_detector
