// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/feature_matcher.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

struct LengthDescriptor : FeatureMatcher::Descriptor {
  explicit LengthDescriptor(std::size_t value) : length(value) {}
  std::size_t length;
};

/// Classifiers are alike if they have the same length.
class LengthMatcher : public FeatureMatcher {
public:
  std::shared_ptr<const Descriptor> parse(const std::string& classifier) const override {
    return std::make_shared<const LengthDescriptor>(classifier.size());
  }
  double logLikelihoodRatio(const Descriptor& a, const Descriptor& b) const override {
    return dynamic_cast<const LengthDescriptor&>(a).length ==
                   dynamic_cast<const LengthDescriptor&>(b).length
               ? 2.0
               : -1.0;
  }
};

class FeatureMatcherTest : public testing::Test {
protected:
  const FeatureMatchers matchers_ = {{"pole", std::make_shared<const LengthMatcher>()}};
  const FeatureMatcher* matcher_ = findMatcher(matchers_, "pole");
};

TEST_F(FeatureMatcherTest, IsFoundByTheTypeOfTheFeature) {
  ASSERT_NE(matcher_, nullptr);
  EXPECT_EQ(findMatcher(matchers_, "corner"), nullptr);
}

TEST_F(FeatureMatcherTest, ParsesOnlyClassifiersOfItsType) {
  EXPECT_NE(parseDescriptor(matchers_, "pole", "abc"), nullptr);
  EXPECT_EQ(parseDescriptor(matchers_, "pole", ""), nullptr);
  EXPECT_EQ(parseDescriptor(matchers_, "corner", "abc"), nullptr);
}

TEST_F(FeatureMatcherTest, TakesTheMostAlikeOfTheKnownDescriptors) {
  const std::vector<DescriptorPointer> known = {matcher_->parse("a"), matcher_->parse("abc")};
  EXPECT_EQ(logLikelihoodRatio(matcher_, matcher_->parse("xyz"), known), 2.0);
  EXPECT_EQ(logLikelihoodRatio(matcher_, matcher_->parse("wxyz"), known), -1.0);
}

TEST_F(FeatureMatcherTest, GivesNoEvidenceWithoutMatcherDescriptorOrKnownOnes) {
  const DescriptorPointer descriptor = matcher_->parse("abc");
  EXPECT_EQ(logLikelihoodRatio(nullptr, descriptor, {descriptor}), 0.0);
  EXPECT_EQ(logLikelihoodRatio(matcher_, nullptr, {descriptor}), 0.0);
  EXPECT_EQ(logLikelihoodRatio(matcher_, descriptor, {}), 0.0);
}

}  // namespace
}  // namespace ram_slam
