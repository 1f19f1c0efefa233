// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <pluginlib/class_loader.hpp>

#include "ram_slam/landmarks/feature_matcher.hpp"

namespace {

TEST(Plugins, MatchersAreFoundByTheTypeOfTheirFeatures) {
  pluginlib::ClassLoader<ram_slam::FeatureMatcher> loader("ram_slam", "ram_slam::FeatureMatcher");
  const std::map<std::string, std::string> free_all_over = {
      {"corner", "pg1:8x24:4.0:" + std::string(64, 'V')},
      {"edge", "pg2:8x48:8.0:100:" + std::string(128, 'V')}};
  for (const auto& [type, classifier] : free_all_over) {
    const auto matcher = loader.createUniqueInstance(type);
    const auto descriptor = matcher->parse(classifier);
    ASSERT_NE(descriptor, nullptr) << type;
    EXPECT_GT(matcher->logLikelihoodRatio(*descriptor, *descriptor), 0.0) << type;
    EXPECT_EQ(matcher->parse("of another scheme"), nullptr) << type;
  }
}

}  // namespace
