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
  ComparableGrid grid;
};

constexpr double kStep = 0.02;
/// ln p(distance | same corner) - ln p(distance | another corner) at distances 0, 0.02, 0.04 ...:
/// between those measured in simulated worlds and in a recorded office, see
/// docs/feature_detector.md.
constexpr std::array kLogLikelihoodRatios = {3.0, 3.0, 2.9, 2.3, 1.5, 0.4, -0.9, -2.0, -2.8, -3.0};

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
  const auto distance = first->grid.distance(second->grid);
  if (!distance) return 0.0;
  const double place = *distance / kStep;
  const auto before = std::min(static_cast<std::size_t>(place), kLogLikelihoodRatios.size() - 1);
  const auto after = std::min(before + 1, kLogLikelihoodRatios.size() - 1);
  const double fraction = place - static_cast<double>(before);
  return kLogLikelihoodRatios[before] +
         fraction * (kLogLikelihoodRatios[after] - kLogLikelihoodRatios[before]);
}

}  // namespace ramscout_feature_detector
