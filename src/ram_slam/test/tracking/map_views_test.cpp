// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/map_views.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "ram_slam/tracking/place_finder.hpp"

#include "../scan_matching/walls.hpp"

namespace ram_slam {
namespace {

/// A room with a niche below and a bay above: nothing repeats.
Walls oddRoom() {
  return outline({{0.0, 0.0},
                  {6.0, 0.0},
                  {6.0, -2.0},
                  {8.0, -2.0},
                  {8.0, 0.0},
                  {14.0, 0.0},
                  {14.0, 3.0},
                  {5.0, 3.0},
                  {5.0, 6.0},
                  {2.0, 6.0},
                  {2.0, 3.0},
                  {0.0, 3.0}});
}

std::shared_ptr<const LaserView> viewIn(const Walls& walls, const Pose2& map_from_base) {
  TestLaser laser;
  laser.beam_count = 720;
  laser.field_of_view_rad = 2.0 * M_PI * 719.0 / 720.0;
  return std::make_shared<const LaserView>(scanWalls(walls, map_from_base, 1, laser), Pose2{});
}

/// Views along the middle of the room.
MapViews viewsOf(const Walls& walls) {
  MapViews views;
  for (int i = 0; i < 12; ++i) {
    const Pose2 pose{1.5 + i, 1.5, 0.0};
    views.add(i + 1, pose, static_cast<double>(i), viewIn(walls, pose));
  }
  return views;
}

/// What a robot that ends there has seen on the last three metres.
std::vector<LocalConstellation::PlacedView> wayTo(const Walls& walls, const Pose2& map_from_base) {
  std::vector<LocalConstellation::PlacedView> way;
  for (const double back_m : {3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0}) {
    const Pose2 base_from_then{-back_m, 0.0, 0.0};
    way.push_back({base_from_then, viewIn(walls, map_from_base * base_from_then)});
  }
  return way;
}

bool isNear(const Pose2& a, const Pose2& b) {
  const Pose2 away = a.inverse() * b;
  return away.translation().norm() < 0.3 && std::abs(away.yaw_rad) < 0.1;
}

TEST(MapViews, AgreeWithTheRightPoseAndContradictAnother) {
  const Walls room = oddRoom();
  const MapViews map = viewsOf(room);
  const auto way = wayTo(room, {9.2, 1.2, 0.1});
  const ViewAgreement right = map.judge(way, {9.2, 1.2, 0.1});
  EXPECT_EQ(right.compared_count, 7);
  EXPECT_LT(right.contradiction, 0.02);
  EXPECT_GT(right.evidence, 2.5);
  const ViewAgreement wrong = map.judge(way, {6.2, 1.2, 0.1});
  EXPECT_EQ(wrong.compared_count, 7);
  EXPECT_GT(wrong.contradiction, 0.1);
  EXPECT_LT(wrong.evidence, -5.0);
}

TEST(MapViews, SayNothingWhereTheMapHasNoViews) {
  const Walls room = oddRoom();
  const MapViews map = viewsOf(room);
  EXPECT_EQ(map.judge(wayTo(room, {9.2, 1.2, 0.1}), {40.0, 1.2, 0.1}).compared_count, 0);
}

TEST(MapViews, AreNoEvidenceForALongWayAfterTheyAgreedUnlessTheMapIsTrusted) {
  const Walls room = oddRoom();
  MapViews map = viewsOf(room);
  const Pose2 wrong{9.0, 1.5, 0.0};
  const auto view = viewIn(room, {3.5, 1.5, 0.0});
  EXPECT_GT(map.watch(*view, wrong, 16.0).value_or(0.0), 0.1);  // added at 7 and 8 m
  EXPECT_FALSE(map.watch(*view, wrong, 30.0));
  EXPECT_FALSE(map.watch(*viewIn(room, wrong), wrong, 30.0));  // agrees from now on
  EXPECT_GT(map.watch(*view, wrong, 31.0).value_or(0.0), 0.1);
  EXPECT_FALSE(map.watch(*view, wrong, 50.0));
  map.trustMap(50.0);
  EXPECT_GT(map.watch(*view, wrong, 51.0).value_or(0.0), 0.1);
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

TEST(MapViews, ProposeBothOfTwoPlacesThatLookAlike) {
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
  EXPECT_LT(map.judge(way, {34.5, 1.5, 0.0}).contradiction, 0.02);
  EXPECT_EQ(map.judge(way, {4.5, 1.5, 0.0}).compared_count, 0);
}

/// Poles beside the way, those that the robot has seen on it, and what finding makes of them.
class FindingPlaces : public testing::Test {
protected:
  static constexpr double kSeen_m = 4.0;

  static ConstellationPoint pole(double x_m, double y_m) {
    ConstellationPoint point;
    point.type = "pole";
    point.position_m = {x_m, y_m};
    point.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
    return point;
  }

  /// The robot drives three metres to the pose, and sees the poles around and the walls.
  static LocalConstellation driveTo(const Walls& walls,
                                    const Constellation& poles,
                                    const Pose2& map_from_base) {
    LocalConstellation local({}, {});
    for (const auto& placed : wayTo(walls, map_from_base)) {
      const Pose2 then = map_from_base * placed.base_from_then;
      FeatureList list;
      list.stamp_ns = 1;
      for (const ConstellationPoint& point : poles) {
        Feature feature;
        feature.type = "pole";
        feature.position_m = then.inverse() * point.position_m;
        feature.covariance_m2 = point.covariance_m2;
        if (feature.position_m.norm() < kSeen_m) list.features.push_back(feature);
      }
      local.add(list,
                local.distance_m() == 0.0 && placed.base_from_then.x_m < -2.9
                    ? Pose2{}
                    : Pose2{0.5, 0.0, 0.0},
                placed.view);
    }
    return local;
  }
};

TEST_F(FindingPlaces, FindsAPlaceOfFewFeaturesByItsWalls) {
  const Walls room = oddRoom();
  const Constellation poles{pole(8.5, 0.0), pole(10.0, 3.0), pole(11.5, 0.0), pole(1.0, 3.0)};
  const Pose2 truth{9.2, 1.2, 0.1};
  const auto place = findPlace(poles, driveTo(room, poles, truth), viewsOf(room), {}, {}, {});
  ASSERT_TRUE(place);
  EXPECT_PRED2(isNear, place->pose, truth);
}

TEST_F(FindingPlaces, DoesNotChooseBetweenTwoPlacesThatLookAlike) {
  const Walls room = rectangle(0.0, 0.0, 14.0, 3.0);
  Constellation poles;
  for (const auto& [x_m, y_m] : {std::pair{8.0, 0.0}, {10.0, 3.0}, {11.5, 0.0}, {9.0, 3.0}}) {
    poles.push_back(pole(x_m, y_m));
    poles.push_back(pole(14.0 - x_m, 3.0 - y_m));
  }
  const Pose2 truth{9.2, 1.2, 0.1};
  const LocalConstellation local = driveTo(room, poles, truth);
  EXPECT_FALSE(findPlace(poles, local, viewsOf(room), {}, {}, {}));
  // Unless it is expected in one of them; a place that does not agree is not taken for that.
  const auto place = findPlace(poles, local, viewsOf(room), truth, {}, {});
  ASSERT_TRUE(place);
  EXPECT_PRED2(isNear, place->pose, truth);
  EXPECT_FALSE(findPlace(poles, local, viewsOf(room), Pose2{7.0, 1.5, 1.0}, {}, {}));
}

TEST_F(FindingPlaces, RefusesAPlaceWhoseWallsAreOthers) {
  // The same poles stand in a corridor without the niche and the bay.
  const Constellation poles{pole(8.5, 0.0), pole(10.0, 3.0), pole(11.5, 0.0),
                            pole(9.0, 3.0), pole(10.5, 0.0), pole(7.5, 3.0)};
  const LocalConstellation local = driveTo(rectangle(-4.0, 0.0, 24.0, 3.0), poles, {9.2, 1.2, 0.1});
  EXPECT_FALSE(findPlace(poles, local, viewsOf(oddRoom()), {}, {}, {}));
  // Without views in the map the poles alone decide.
  EXPECT_TRUE(findPlace(poles, local, {}, {}, {}, {}));
}

}  // namespace
}  // namespace ram_slam
