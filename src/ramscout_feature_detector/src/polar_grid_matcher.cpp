// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/polar_grid_matcher.hpp"

#include <algorithm>
#include <cmath>

#include "ramscout_feature_detector/polar_grid.hpp"

namespace ramscout_feature_detector {
namespace {

struct GridDescriptor : ram_slam::FeatureMatcher::Descriptor {
  explicit GridDescriptor(const PolarGrid& described) : grid(described) {}
  ComparableGrid grid;
};

constexpr double kStep = 0.02;

}  // namespace

std::shared_ptr<const ram_slam::FeatureMatcher::Descriptor> PolarGridMatcher::parse(
    const std::string& classifier) const {
  const auto grid = PolarGrid::parse(classifier);
  if (!grid) return nullptr;
  return std::make_shared<GridDescriptor>(*grid);
}

double PolarGridMatcher::logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const {
  const auto* first = dynamic_cast<const GridDescriptor*>(&a);
  const auto* second = dynamic_cast<const GridDescriptor*>(&b);
  if (first == nullptr || second == nullptr) return 0.0;
  const auto distance = first->grid.distance(second->grid);
  if (!distance) return 0.0;
  const double place = *distance / kStep;
  const auto before = std::min(static_cast<std::size_t>(place), ratios_.size() - 1);
  const auto after = std::min(before + 1, ratios_.size() - 1);
  const double fraction = place - static_cast<double>(before);
  return ratios_[before] + fraction * (ratios_[after] - ratios_[before]);
}

}  // namespace ramscout_feature_detector
