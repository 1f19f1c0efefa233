// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/view_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ramscout_feature_detector/edge_matcher.hpp"

#include "random_world.hpp"

namespace ramscout_feature_detector {
namespace {

const Eigen::Vector2d kPlaceM(2.0, 0.5);

PolygonWorld room() {
  PolygonWorld world;
  world.add({{-3.0, -2.0}, {4.0, -2.0}, {4.0, 3.0}, {1.0, 3.0}, {1.0, 5.0}, {-3.0, 5.0}}, true);
  world.add({{2.0, 0.5}, {3.0, 0.5}, {3.0, 1.0}, {2.0, 1.0}}, true);
  return world;
}

ram_slam::LaserScan scanFrom(const ram_slam::Pose2& pose) {
  ram_slam::Random random(1);
  return room().scan(pose, 0.0, random, 1440, -M_PI, M_PI / 720.0);
}

double distanceBetween(const ViewGrid& a, const ViewGrid& b) {
  return ComparableView(a).distance(ComparableView(b)).value();
}

TEST(ViewGrid, IsWrittenAsItIsRead) {
  const ViewGrid grid = ViewGrid::around(kPlaceM, scanFrom({}));
  const std::string text = grid.toString();
  EXPECT_THAT(text, testing::StartsWith("pg2:8x48:8.0:206:"));
  EXPECT_EQ(text.size(), 17U + 128U);
  const auto read = ViewGrid::parse(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->toString(), text);
  EXPECT_DOUBLE_EQ(read->range_m(), 2.06);
}

TEST(ViewGrid, KnowsWhatIsFreeBeforeAndUnknownBehind) {
  const ViewGrid grid = ViewGrid::around(kPlaceM, scanFrom({}));
  EXPECT_EQ(grid.at(4, 0), PolarGrid::kFree);  // 1.5 to 2.3 m towards the laser
  EXPECT_EQ(grid.at(4, 24), PolarGrid::kUnknown);
}

TEST(ViewGrid, AnythingElseIsNotRead) {
  const std::string text = ViewGrid::around(kPlaceM, scanFrom({})).toString();
  const std::string cells = text.substr(17);
  for (const std::string& bad :
       {std::string(), std::string("pg2:8x48:8.0:"), std::string("pg2:8x48:8.0::") + cells,
        "pg1:8x48:8.0:206:" + cells, "pg2:8x48:8.0:2 6:" + cells, "pg2:8x48:8.0:-20:" + cells,
        "pg2:8x48:8.0:0206:" + cells, "pg2:8x48:8.0:9999999:" + cells,
        "pg2:8x48:8.0:100001:" + cells, text + "A", text.substr(0, text.size() - 1),
        text.substr(0, text.size() - 1) + "*"}) {
    EXPECT_FALSE(ViewGrid::parse(bad)) << bad;
    EXPECT_EQ(EdgeMatcher().parse(bad), nullptr) << bad;
  }
  EXPECT_TRUE(ViewGrid::parse("pg2:8x48:8.0:0:" + cells));
}

TEST(ViewGrid, IsTheSameWhateverTheLasersHeading) {
  const std::string expected = ViewGrid::around(kPlaceM, scanFrom({})).toString();
  for (const int beams : {1, 100, 720, -355}) {
    const ram_slam::Pose2 pose{0.0, 0.0, beams * M_PI / 720.0};
    EXPECT_EQ(ViewGrid::around(pose.inverse() * kPlaceM, scanFrom(pose)).toString(), expected);
  }
}

TEST(ViewGrid, ViewsFromNearbyAreAlikeAndOtherPlacesAreNot) {
  const ViewGrid grid = ViewGrid::around(kPlaceM, scanFrom({}));
  const ram_slam::Pose2 nearby{0.5, -0.5, 0.3};
  const ViewGrid again = ViewGrid::around(nearby.inverse() * kPlaceM, scanFrom(nearby));
  const ViewGrid other = ViewGrid::around({1.0, 3.0}, scanFrom({}));
  EXPECT_LT(distanceBetween(grid, grid), 0.05);
  EXPECT_LT(distanceBetween(grid, again), 0.09);
  EXPECT_GT(distanceBetween(grid, other), 0.14);
  EXPECT_DOUBLE_EQ(distanceBetween(grid, other), distanceBetween(other, grid));
  const EdgeMatcher matcher;
  const auto ratio = [&](const ViewGrid& a, const ViewGrid& b) {
    return matcher.logLikelihoodRatio(*matcher.parse(a.toString()), *matcher.parse(b.toString()));
  };
  EXPECT_GT(ratio(grid, again), 2.0);
  EXPECT_LT(ratio(grid, other), 0.0);
}

TEST(ViewGrid, NothingSeenDecidesNothing) {
  const auto empty = ViewGrid::parse("pg2:8x48:8.0:100:" + std::string(128, 'A'));
  ASSERT_TRUE(empty);
  EXPECT_FALSE(ComparableView(*empty).distance(ComparableView(*empty)));
  const EdgeMatcher matcher;
  const auto descriptor = matcher.parse(empty->toString());
  EXPECT_EQ(matcher.logLikelihoodRatio(*descriptor, *descriptor), 0.0);
}

}  // namespace
}  // namespace ramscout_feature_detector
