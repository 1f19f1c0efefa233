// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/corner_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ramscout_feature_detector/polar_grid.hpp"

namespace ramscout_feature_detector {
namespace {

struct GridDescriptor : ram_slam::FeatureMatcher::Descriptor {
  explicit GridDescriptor(const PolarGrid& described) : grid(described) {}
  PolarGrid grid;
};

constexpr double kBinWidth = 0.02;
/// ln p(distance | same corner) - ln p(distance | another corner), by distance.
constexpr std::array kLogLikelihoodRatios = {3.0,  2.6,  2.0,  1.4,  0.8,  0.3,  -0.2,
                                             -0.7, -1.2, -1.7, -2.1, -2.5, -2.8, -3.0};

}  // namespace

std::shared_ptr<const ram_slam::FeatureMatcher::Descriptor> CornerMatcher::parse(
    const std::string& classifier) const {
  const auto grid = PolarGrid::parse(classifier);
  if (!grid) return nullptr;
  return std::make_shared<GridDescriptor>(*grid);
}

double CornerMatcher::logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const {
  const auto* first = dynamic_cast<const GridDescriptor*>(&a);
  const auto* second = dynamic_cast<const GridDescriptor*>(&b);
  if (first == nullptr || second == nullptr) return 0.0;
  const auto difference = distance(first->grid, second->grid);
  if (!difference) return 0.0;
  const auto bin = static_cast<std::size_t>(*difference / kBinWidth);
  return kLogLikelihoodRatios[std::min(bin, kLogLikelihoodRatios.size() - 1)];
}

}  // namespace ramscout_feature_detector
