// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string>

#include "ram_slam/landmarks/feature_matcher.hpp"

namespace ramscout_feature_detector {

/// Compares features by their surroundings (PolarGrid).
class PolarGridMatcher : public ram_slam::FeatureMatcher {
public:
  /// ln p(distance | same feature) - ln p(distance | another feature) at distances of 0, 0.02, ...
  /// 0.18 between two grids (ComparableGrid::distance()).
  using Ratios = std::array<double, 10>;

  explicit PolarGridMatcher(const Ratios& ratios) : ratios_(ratios) {}

  std::shared_ptr<const Descriptor> parse(const std::string& classifier) const override;

  /// Within [-ln 20, ln 20]: a place is semi-unique, never more. 0 if too little is seen of
  /// both.
  double logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const override;

private:
  Ratios ratios_;
};

}  // namespace ramscout_feature_detector
