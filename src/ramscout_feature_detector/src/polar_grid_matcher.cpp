// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/polar_grid_matcher.hpp"

#include "ramscout_feature_detector/polar_grid.hpp"

#include "ratio_table.hpp"

namespace ramscout_feature_detector {
namespace {

struct GridDescriptor : ram_slam::FeatureMatcher::Descriptor {
  explicit GridDescriptor(const PolarGrid& described) : grid(described) {}
  ComparableGrid grid;
};

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
  return ratioAt(*distance, ratios_);
}

}  // namespace ramscout_feature_detector
