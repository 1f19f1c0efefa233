// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ram_slam {

/// Standard deviation of a normal distribution over its median absolute value.
constexpr double kDeviationPerMedian = 1.4826;

/// The median; of an even number of values the upper one of the middle two.
/// \param values  at least one
template <typename Value>
Value median(std::vector<Value> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ram_slam
