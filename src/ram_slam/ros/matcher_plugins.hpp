// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pluginlib/class_loader.hpp>

#include "ram_slam/landmarks/feature_matcher.hpp"

namespace ram_slam_ros {

/// The feature matchers that packages of this system declare as plugins; one that cannot be loaded
/// is reported and left out.
class MatcherPlugins {
public:
  MatcherPlugins();

  const ram_slam::FeatureMatchers& matchers() const { return matchers_; }

private:
  pluginlib::ClassLoader<ram_slam::FeatureMatcher> loader_;
  ram_slam::FeatureMatchers matchers_;
};

}  // namespace ram_slam_ros
