// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge_matcher.hpp"

#include <array>

#include "ramscout_feature_detector/view_grid.hpp"

#include "ratio_table.hpp"

namespace ramscout_feature_detector {
namespace {

struct ViewDescriptor : ram_slam::FeatureMatcher::Descriptor {
  explicit ViewDescriptor(const ViewGrid& described) : view(described) {}
  ComparableView view;
};

/// ln p(distance | same feature) - ln p(distance | another feature) at distances of 0, 0.02, ...
/// 0.22 (ComparableView::distance()): between those measured in simulated worlds and in two
/// recorded offices, see docs/feature_detector.md.
constexpr std::array kRatios = {3.0, 3.0, 3.0, 3.0, 3.0, 2.8, 1.2, -0.5, -1.6, -2.3, -2.8, -3.0};

}  // namespace

std::shared_ptr<const ram_slam::FeatureMatcher::Descriptor> EdgeMatcher::parse(
    const std::string& classifier) const {
  const auto grid = ViewGrid::parse(classifier);
  if (!grid) return nullptr;
  return std::make_shared<ViewDescriptor>(*grid);
}

double EdgeMatcher::logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const {
  const auto* first = dynamic_cast<const ViewDescriptor*>(&a);
  const auto* second = dynamic_cast<const ViewDescriptor*>(&b);
  if (first == nullptr || second == nullptr) return 0.0;
  const auto distance = first->view.distance(second->view);
  return distance ? ratioAt(*distance, kRatios) : 0.0;
}

}  // namespace ramscout_feature_detector
