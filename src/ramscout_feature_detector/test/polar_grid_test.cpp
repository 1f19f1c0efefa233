// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/polar_grid.hpp"

#include <gtest/gtest.h>

#include "ramscout_feature_detector/corner_matcher.hpp"

#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

PolarGrid gridInARoom(double orientation_rad) {
  ram_slam::Random random(1);
  PolygonWorld room;
  room.add({{-2.0, -3.0}, {4.0, -3.0}, {4.0, 2.0}, {-2.0, 3.0}}, true);
  const auto scan = room.scan({}, 0.0, random, 1440, -M_PI, M_PI / 720.0);
  return PolarGrid::around({4.0, 2.0}, orientation_rad, scan);
}

TEST(PolarGrid, TextRoundTrip) {
  const PolarGrid grid = gridInARoom(-2.0);
  const std::string text = grid.toString();
  EXPECT_EQ(text.size(), 77U);
  const auto back = PolarGrid::parse(text);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->toString(), text);
  EXPECT_EQ(distance(grid, *back), 0.0);
}

TEST(PolarGrid, OtherTextsAreNoGrid) {
  const std::string text = gridInARoom(-2.0).toString();
  EXPECT_FALSE(PolarGrid::parse(""));
  EXPECT_FALSE(PolarGrid::parse("pg2" + text.substr(3)));
  EXPECT_FALSE(PolarGrid::parse(text.substr(0, text.size() - 1)));
  EXPECT_FALSE(PolarGrid::parse(text + "A"));
  EXPECT_FALSE(PolarGrid::parse(text.substr(0, text.size() - 1) + "="));
}

TEST(PolarGrid, BisectorOfARoomsCornerLooksIntoFreeSpace) {
  const PolarGrid grid = gridInARoom(-2.36);
  EXPECT_EQ(grid.at(3, 0), PolarGrid::kFree);
  EXPECT_EQ(grid.at(3, 12), PolarGrid::kUnknown);
}

TEST(PolarGrid, DistanceIsSymmetricAndForgivesOneSector) {
  const PolarGrid a = gridInARoom(-2.0);
  const PolarGrid b = gridInARoom(-2.0 + 2.0 * M_PI / PolarGrid::kSectors);
  const PolarGrid c = gridInARoom(-2.0 + 0.7);
  ASSERT_TRUE(distance(a, b) && distance(a, c));
  EXPECT_LT(*distance(a, b), 0.01);
  EXPECT_GT(*distance(a, c), 5.0 * *distance(a, b));
  EXPECT_DOUBLE_EQ(*distance(a, c), *distance(c, a));
}

TEST(CornerMatcher, EqualSurroundingsSpeakForTheSameCorner) {
  const CornerMatcher matcher;
  const auto a = matcher.parse(gridInARoom(-2.36).toString());
  const auto b = matcher.parse(gridInARoom(-2.36 + M_PI).toString());
  ASSERT_TRUE(a && b);
  EXPECT_GT(matcher.logLikelihoodRatio(*a, *a), 1.0);
  EXPECT_LE(matcher.logLikelihoodRatio(*a, *b), 0.0);
}

TEST(CornerMatcher, UnreadableClassifiersSayNothing) {
  EXPECT_EQ(CornerMatcher().parse("pg9:unheard-of"), nullptr);
  EXPECT_EQ(CornerMatcher().parse(std::string(5000, 'A')), nullptr);
}

}  // namespace
}  // namespace ramscout_feature_detector
