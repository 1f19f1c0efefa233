// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

namespace ram_slam {

/// How alike two classifiers of one feature type are. The detector's package implements it; the
/// estimator looks it up by the feature's type and knows nothing but this interface, so that
/// association by looks belongs to the detector and association by geometry to the estimator.
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

  /// ln p(a, b | same thing) - ln p(a, b | different things): 0 says nothing, positive speaks for
  /// the same thing. Both arguments come from parse() of this matcher.
  virtual double logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const = 0;
};

}  // namespace ram_slam
