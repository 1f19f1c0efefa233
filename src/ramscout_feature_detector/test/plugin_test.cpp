// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <pluginlib/class_loader.hpp>

#include "ram_slam/feature_matcher.hpp"

namespace {

TEST(Plugins, MatchersAreFoundByTheTypeOfTheirFeatures) {
  pluginlib::ClassLoader<ram_slam::FeatureMatcher> loader("ram_slam", "ram_slam::FeatureMatcher");
  const std::string classifier = "pg1:8x24:4.0:" + std::string(64, 'V');  // free all over
  for (const char* type : {"corner", "edge"}) {
    const auto matcher = loader.createUniqueInstance(type);
    const auto descriptor = matcher->parse(classifier);
    ASSERT_NE(descriptor, nullptr) << type;
    EXPECT_GT(matcher->logLikelihoodRatio(*descriptor, *descriptor), 0.0) << type;
    EXPECT_EQ(matcher->parse("of another scheme"), nullptr) << type;
  }
}

}  // namespace
