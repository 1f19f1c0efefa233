// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge_matcher.hpp"

#include <gtest/gtest.h>

#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/view_grid.hpp"

namespace ramscout_feature_detector {
namespace {

/// A classifier of edges seen from 1 m all cells of which are alike: A unknown, V free, / occupied.
std::string classifier(char cells) {
  return "pg2:8x48:8.0:100:" + std::string(128, cells);
}

double ratio(const std::string& a, const std::string& b) {
  const EdgeMatcher matcher;
  return matcher.logLikelihoodRatio(*matcher.parse(a), *matcher.parse(b));
}

TEST(EdgeMatcher, EqualSurroundingsSupportTheSameEdge) {
  EXPECT_NEAR(ratio(classifier('V'), classifier('V')), 3.0, 1e-9);
}

TEST(EdgeMatcher, OppositeSurroundingsContradict) {
  EXPECT_NEAR(ratio(classifier('V'), classifier('/')), -3.0, 1e-9);
}

TEST(EdgeMatcher, UnknownSurroundingsDecideNothing) {
  EXPECT_EQ(ratio(classifier('A'), classifier('V')), 0.0);
  EXPECT_EQ(ratio(classifier('A'), classifier('A')), 0.0);
}

TEST(EdgeMatcher, FartherLasersSupportLess) {
  const std::string far = "pg2:8x48:8.0:900:" + std::string(128, 'V');
  EXPECT_LE(ratio(classifier('V'), far), ratio(classifier('V'), classifier('V')));
  EXPECT_DOUBLE_EQ(ratio(classifier('V'), far), ratio(far, classifier('V')));
}

TEST(EdgeMatcher, BeyondTheTableTheLastRatioCounts) {
  const std::string half_occupied =
      "pg2:8x48:8.0:100:" + std::string(64, 'V') + std::string(64, '/');
  const double distance = ComparableView(*ViewGrid::parse(classifier('V')))
                              .distance(ComparableView(*ViewGrid::parse(half_occupied)))
                              .value();
  EXPECT_GT(distance, 0.22);  // beyond the table: its last value
  EXPECT_NEAR(ratio(classifier('V'), half_occupied), -3.0, 1e-9);
}

TEST(EdgeMatcher, DescriptorsOfOtherMatchersDecideNothing) {
  const EdgeMatcher edges;
  const CornerMatcher corners;
  const auto edge = edges.parse(classifier('V'));
  const auto corner = corners.parse("pg1:8x24:4.0:" + std::string(64, 'V'));
  ASSERT_TRUE(edge && corner);
  EXPECT_EQ(edges.logLikelihoodRatio(*edge, *corner), 0.0);
  EXPECT_EQ(corners.logLikelihoodRatio(*corner, *edge), 0.0);
}

TEST(EdgeMatcher, OtherTextsAreNoDescriptor) {
  EXPECT_EQ(EdgeMatcher().parse(""), nullptr);
  EXPECT_EQ(EdgeMatcher().parse("pg1:8x24:4.0:" + std::string(64, 'V')), nullptr);
}

}  // namespace
}  // namespace ramscout_feature_detector
