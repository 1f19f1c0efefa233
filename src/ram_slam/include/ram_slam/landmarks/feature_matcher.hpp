// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ram_slam {

/// How alike two classifiers of one feature type are. The detector's package implements it; the
/// estimator finds it by the feature's type and knows nothing but this interface, so that
/// association by appearance belongs to the detector and association by geometry to the estimator.
///
/// A plugin (pluginlib) of base class `ram_slam::FeatureMatcher`, registered under the name of the
/// feature type.
class FeatureMatcher {
public:
  /// A classifier, parsed once so that comparing is cheap.
  class Descriptor {
  public:
    virtual ~Descriptor() = default;
  };

  virtual ~FeatureMatcher() = default;

  /// The parsed classifier, or null if it is empty, malformed or of an unknown scheme: then there
  /// is no evidence either way. Never throws on content.
  virtual std::shared_ptr<const Descriptor> parse(const std::string& classifier) const = 0;

  /// ln p(a, b | same thing) - ln p(a, b | different things): 0 is no evidence, positive favours
  /// the same thing. Both arguments come from parse() of this matcher.
  virtual double logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const = 0;
};

using DescriptorPointer = std::shared_ptr<const FeatureMatcher::Descriptor>;
/// The matcher of each type of feature; a type without one is matched by geometry alone.
using FeatureMatchers = std::map<std::string, std::shared_ptr<const FeatureMatcher>>;

/// Null if the type has none.
const FeatureMatcher* findMatcher(const FeatureMatchers& matchers, const std::string& type);

/// The parsed classifier; null without a matcher for the type or without a classifier.
DescriptorPointer parseDescriptor(const FeatureMatchers& matchers,
                                  const std::string& type,
                                  const std::string& classifier);

/// The largest of the log-likelihood ratios between a descriptor and the known ones; 0 without a
/// matcher, a descriptor or a known one.
double logLikelihoodRatio(const FeatureMatcher* matcher,
                          const DescriptorPointer& descriptor,
                          const std::vector<DescriptorPointer>& known);

}  // namespace ram_slam
