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

std::optional<double> distanceOf(const PolarGrid& a, const PolarGrid& b) {
  return ComparableGrid(a).distance(ComparableGrid(b));
}

TEST(PolarGrid, TextRoundTrip) {
  const PolarGrid grid = gridInARoom(-2.0);
  const std::string text = grid.toString();
  EXPECT_EQ(text.size(), 77U);
  const auto back = PolarGrid::parse(text);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->toString(), text);
  EXPECT_EQ(distanceOf(grid, *back), distanceOf(grid, grid));
}

TEST(PolarGrid, OtherTextsAreNoGrid) {
  const std::string text = gridInARoom(-2.0).toString();
  EXPECT_FALSE(PolarGrid::parse(""));
  EXPECT_FALSE(PolarGrid::parse("pg2" + text.substr(3)));
  EXPECT_FALSE(PolarGrid::parse(text.substr(0, text.size() - 1)));
  EXPECT_FALSE(PolarGrid::parse(text + "A"));
  EXPECT_FALSE(PolarGrid::parse(text.substr(0, text.size() - 1) + "="));
}

TEST(PolarGrid, BisectorOfARoomsCornerPointsIntoFreeSpace) {
  const PolarGrid grid = gridInARoom(-2.36);
  EXPECT_EQ(grid.at(3, 0), PolarGrid::kFree);
  EXPECT_EQ(grid.at(3, 12), PolarGrid::kUnknown);
}

TEST(ComparableGrid, DistanceIsSymmetricAndForgivesOneSector) {
  const PolarGrid a = gridInARoom(-2.0);
  const PolarGrid b = gridInARoom(-2.0 + 2.0 * M_PI / PolarGrid::kSectors);
  const PolarGrid c = gridInARoom(-2.0 + 0.7);
  ASSERT_TRUE(distanceOf(a, b) && distanceOf(a, c));
  EXPECT_NEAR(*distanceOf(a, b), *distanceOf(a, a), 0.03);
  EXPECT_GT(*distanceOf(a, c), *distanceOf(a, b) + 0.05);
  EXPECT_DOUBLE_EQ(*distanceOf(a, c), *distanceOf(c, a));
}

TEST(ComparableGrid, DistanceIsThatOfTheFormula) {
  ram_slam::Random random(3);
  for (int i = 0; i < 50; ++i) {
    PolarGrid a, b;
    for (int cell = 0; cell < PolarGrid::kCells; ++cell) {
      a.set(cell / 24, cell % 24, static_cast<PolarGrid::Cell>(random() % 4));
      b.set(cell / 24, cell % 24, static_cast<PolarGrid::Cell>(random() % 4));
    }
    double expected = 2.0;
    for (int turn = -1; turn <= 1; ++turn) {
      double sum = 0.0;
      int common = 0, one_sided = 0;
      for (int cell = 0; cell < PolarGrid::kCells; ++cell) {
        const int of_a = a.at(cell / 24, cell % 24);
        const int of_b = b.at(cell / 24, cell % 24 + turn);
        if ((of_a == 0) != (of_b == 0)) ++one_sided;
        if (of_a == 0 || of_b == 0) continue;
        ++common;
        sum += std::pow(0.5 * (of_a - of_b), 2.0);
      }
      const double distance =
          (sum + 2.4) / (common + 20.0) + 0.1 * one_sided / 192.0 + 0.01 * std::abs(turn);
      expected = std::min(expected, distance);
    }
    EXPECT_NEAR(*distanceOf(a, b), expected, 1e-12);
  }
}

TEST(ComparableGrid, GridsThatShareTooLittleHaveNoDistance) {
  PolarGrid a;
  PolarGrid b;
  for (int cell = 0; cell < 30; ++cell) {
    a.set(cell / 24, cell % 24, PolarGrid::kFree);
    b.set(cell / 24, cell % 24, PolarGrid::kFree);
  }
  EXPECT_FALSE(distanceOf(a, b));
}

TEST(CornerMatcher, EqualSurroundingsSupportTheSameCorner) {
  const CornerMatcher matcher;
  const auto a = matcher.parse(gridInARoom(-2.36).toString());
  const auto b = matcher.parse(gridInARoom(-2.36 + M_PI).toString());
  ASSERT_TRUE(a && b);
  EXPECT_GT(matcher.logLikelihoodRatio(*a, *a), 1.0);
  EXPECT_LE(matcher.logLikelihoodRatio(*a, *b), 0.0);
}

TEST(CornerMatcher, UnreadableClassifiersAreIgnored) {
  EXPECT_EQ(CornerMatcher().parse("pg9:unheard-of"), nullptr);
  EXPECT_EQ(CornerMatcher().parse(std::string(5000, 'A')), nullptr);
}

}  // namespace
}  // namespace ramscout_feature_detector
