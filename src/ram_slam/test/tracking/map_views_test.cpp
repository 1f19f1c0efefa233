// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/map_views.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "rooms.hpp"

namespace ram_slam {
namespace {

TEST(MapViews, AgreeWithTheRightPoseAndContradictAnother) {
  const Walls room = oddRoom();
  const MapViews map = viewsOf(room);
  const auto way = wayTo(room, {9.2, 1.2, 0.1});
  const ViewAgreement right = map.judge(way, {9.2, 1.2, 0.1});
  EXPECT_EQ(right.compared_count, 7);
  EXPECT_LT(right.contradiction_ratio, 0.02);
  EXPECT_GT(right.evidence, 2.5);
  const ViewAgreement wrong = map.judge(way, {6.2, 1.2, 0.1});
  EXPECT_EQ(wrong.compared_count, 7);
  EXPECT_GT(wrong.contradiction_ratio, 0.1);
  EXPECT_LT(wrong.evidence, -5.0);
}

TEST(MapViews, HaveNoEvidenceWhereTheMapHasNoViews) {
  const Walls room = oddRoom();
  const MapViews map = viewsOf(room);
  EXPECT_EQ(map.judge(wayTo(room, {9.2, 1.2, 0.1}), {40.0, 1.2, 0.1}).compared_count, 0);
}

TEST(MapViews, AreNoEvidenceForALongWayAfterTheyAgreedUnlessTheMapIsTrusted) {
  const Walls room = oddRoom();
  MapViews map = viewsOf(room);
  const Pose2 wrong{9.0, 1.5, 0.0};
  const auto view = viewIn(room, {3.5, 1.5, 0.0});
  EXPECT_GT(map.trackedContradictionRatio(*view, wrong, 16.0).value_or(0.0),
            0.1);  // added at 7 and 8 m
  EXPECT_FALSE(map.trackedContradictionRatio(*view, wrong, 30.0));
  EXPECT_FALSE(
      map.trackedContradictionRatio(*viewIn(room, wrong), wrong, 30.0));  // agrees from now on
  EXPECT_GT(map.trackedContradictionRatio(*view, wrong, 31.0).value_or(0.0), 0.1);
  EXPECT_FALSE(map.trackedContradictionRatio(*view, wrong, 50.0));
  map.trustMap(50.0);
  EXPECT_GT(map.trackedContradictionRatio(*view, wrong, 51.0).value_or(0.0), 0.1);
}

TEST(MapViews, CorrectAPoseThatIsALittleOff) {
  const Walls room = oddRoom();
  const MapViews map = viewsOf(room);
  const Pose2 truth{9.2, 1.2, 0.1};
  const auto way = wayTo(room, truth);
  const Pose2 off{9.4, 1.3, 0.25};
  const Pose2 better = map.refined(way, off);
  EXPECT_LT((better.translation() - truth.translation()).norm(), 0.15);
  EXPECT_LT(std::abs(better.yaw_rad - truth.yaw_rad), 0.05);
}

TEST(MapViews, ProposeThePlaceOfTheRobotFirst) {
  const Walls room = oddRoom();
  const MapViews map = viewsOf(room);
  for (const Pose2& truth : {Pose2{9.2, 1.2, 0.1}, Pose2{4.0, 1.6, 2.9}, Pose2{12.0, 1.5, -0.2}}) {
    const std::vector<Pose2> places = map.candidates(wayTo(room, truth));
    ASSERT_FALSE(places.empty());
    EXPECT_PRED2(isNear, places.front(), truth);
  }
}

TEST(MapViews, ProposeBothOfTwoPlacesThatAreAlike) {
  const Walls room = rectangle(0.0, 0.0, 14.0, 3.0);
  const MapViews map = viewsOf(room);
  const Pose2 truth{9.2, 1.2, 0.1};
  const Pose2 turned{14.0 - 9.2, 3.0 - 1.2, 0.1 - M_PI};
  const std::vector<Pose2> places = map.candidates(wayTo(room, truth));
  for (const Pose2& wanted : {truth, turned}) {
    EXPECT_TRUE(std::any_of(places.begin(), places.end(),
                            [&](const Pose2& place) { return isNear(place, wanted); }));
  }
}

TEST(MapViews, KeepOneViewPerPlace) {
  const Walls room = oddRoom();
  MapViews map = viewsOf(room);
  const std::size_t size = map.size();
  map.add(100, {5.6, 1.5, 0.2}, 0.0, viewIn(room, {5.6, 1.5, 0.2}));
  EXPECT_EQ(map.size(), size);
  map.add(101, {5.6, 1.5, 1.5}, 0.0, viewIn(room, {5.6, 1.5, 1.5}));
  EXPECT_EQ(map.size(), size + 1);
}

TEST(MapViews, FollowTheirPathAndLeaveWithIt) {
  const Walls room = oddRoom();
  MapViews map = viewsOf(room);
  Trajectory path;
  for (int i = 0; i < 6; ++i) path.push_back({i + 1, {31.5 + i, 1.5, 0.0}});
  map.follow(path);
  EXPECT_EQ(map.size(), 6U);
  const auto way = wayTo(room, {4.5, 1.5, 0.0});
  EXPECT_LT(map.judge(way, {34.5, 1.5, 0.0}).contradiction_ratio, 0.02);
  EXPECT_EQ(map.judge(way, {4.5, 1.5, 0.0}).compared_count, 0);
}

TEST(MapViews, LoadedOnesStayWhereTheyAreOnEveryPath) {
  const Walls room = oddRoom();
  MapViews map;
  const Pose2 pose{9.2, 1.2, 0.1};
  map.addLoaded({pose, viewIn(room, pose)});
  map.addLoaded({pose, viewIn(room, pose)});  // of the same place
  EXPECT_EQ(map.size(), 1u);
  map.follow(Trajectory{{1, {50.0, 50.0, 0.0}}, {2, {51.0, 50.0, 0.0}}});
  EXPECT_EQ(map.size(), 1u);
  EXPECT_LT(map.contradictionRatio(*viewIn(room, pose), pose).value_or(1.0), 0.02);
}

}  // namespace
}  // namespace ram_slam
