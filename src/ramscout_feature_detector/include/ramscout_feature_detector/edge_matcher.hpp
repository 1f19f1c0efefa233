// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ramscout_feature_detector/polar_grid_matcher.hpp"

namespace ramscout_feature_detector {

/// Compares edges, features of type "edge".
class EdgeMatcher : public PolarGridMatcher {
public:
  /// Ratios between those measured in two recorded offices, see docs/feature_detector.md.
  EdgeMatcher() : PolarGridMatcher({3.0, 3.0, 3.0, 3.0, 2.9, 2.0, 0.7, -0.4, -1.0, -1.4}) {}
};

}  // namespace ramscout_feature_detector
