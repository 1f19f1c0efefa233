// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/feature_matcher.hpp"

#include <algorithm>

namespace ram_slam {

const FeatureMatcher* findMatcher(const FeatureMatchers& matchers, const std::string& type) {
  const auto place = matchers.find(type);
  return place == matchers.end() ? nullptr : place->second.get();
}

DescriptorPointer parseDescriptor(const FeatureMatchers& matchers,
                                  const std::string& type,
                                  const std::string& classifier) {
  const FeatureMatcher* const matcher = findMatcher(matchers, type);
  return matcher != nullptr && !classifier.empty() ? matcher->parse(classifier) : nullptr;
}

double logLikelihoodRatio(const FeatureMatcher* matcher,
                          const DescriptorPointer& descriptor,
                          const std::vector<DescriptorPointer>& known) {
  if (matcher == nullptr || descriptor == nullptr || known.empty()) return 0.0;
  double best = matcher->logLikelihoodRatio(*descriptor, *known[0]);
  for (std::size_t i = 1; i < known.size(); ++i) {
    best = std::max(best, matcher->logLikelihoodRatio(*descriptor, *known[i]));
  }
  return best;
}

}  // namespace ram_slam
