// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "ram_slam/landmarks/feature_matcher.hpp"

namespace ramscout_feature_detector {

/// Compares edges, features of type "edge", by the appearance of their surroundings (ViewGrid).
class EdgeMatcher : public ram_slam::FeatureMatcher {
public:
  std::shared_ptr<const Descriptor> parse(const std::string& classifier) const override;

  /// Within [-3, 3]: a place is semi-unique, never more. 0 if too little is seen of both.
  double logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const override;
};

}  // namespace ramscout_feature_detector
