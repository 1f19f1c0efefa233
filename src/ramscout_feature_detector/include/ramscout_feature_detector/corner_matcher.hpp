// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ramscout_feature_detector/polar_grid_matcher.hpp"

namespace ramscout_feature_detector {

/// Compares corners, features of type "corner".
class CornerMatcher : public PolarGridMatcher {
public:
  /// Ratios between those measured in simulated worlds and in a recorded office, see
  /// docs/feature_detector.md.
  CornerMatcher() : PolarGridMatcher({3.0, 3.0, 2.9, 2.3, 1.5, 0.4, -0.9, -2.0, -2.8, -3.0}) {}
};

}  // namespace ramscout_feature_detector
