// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/place_finder.hpp"

#include <gmock/gmock.h>

#include "rooms.hpp"

namespace ram_slam {
namespace {

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
  const auto place = findPlace({poles, viewsOf(room), driveTo(room, poles, truth), {}}, {}, {});
  ASSERT_TRUE(place);
  EXPECT_PRED2(isNear, place->pose, truth);
}

TEST_F(FindingPlaces, DoesNotChooseBetweenTwoPlacesThatAreAlike) {
  const Walls room = rectangle(0.0, 0.0, 14.0, 3.0);
  Constellation poles;
  for (const auto& [x_m, y_m] : {std::pair{8.0, 0.0}, {10.0, 3.0}, {11.5, 0.0}, {9.0, 3.0}}) {
    poles.push_back(pole(x_m, y_m));
    poles.push_back(pole(14.0 - x_m, 3.0 - y_m));
  }
  const Pose2 truth{9.2, 1.2, 0.1};
  const LocalConstellation local = driveTo(room, poles, truth);
  EXPECT_FALSE(findPlace({poles, viewsOf(room), local, {}}, {}, {}));
  // Unless it is expected in one of them; a place that does not agree is not taken for that.
  const auto place = findPlace({poles, viewsOf(room), local, truth}, {}, {});
  ASSERT_TRUE(place);
  EXPECT_PRED2(isNear, place->pose, truth);
  EXPECT_FALSE(findPlace({poles, viewsOf(room), local, Pose2{7.0, 1.5, 1.0}}, {}, {}));
}

TEST_F(FindingPlaces, RefusesAPlaceWhoseWallsAreOthers) {
  // The same poles stand in a corridor without the niche and the bay.
  const Constellation poles{pole(8.5, 0.0), pole(10.0, 3.0), pole(11.5, 0.0),
                            pole(9.0, 3.0), pole(10.5, 0.0), pole(7.5, 3.0)};
  const LocalConstellation local = driveTo(rectangle(-4.0, 0.0, 24.0, 3.0), poles, {9.2, 1.2, 0.1});
  EXPECT_FALSE(findPlace({poles, viewsOf(oddRoom()), local, {}}, {}, {}));
  // Without views in the map the poles alone decide.
  EXPECT_TRUE(findPlace({poles, MapViews(), local, {}}, {}, {}));
}

TEST(MissingLandmarks, CountAgainstAPoseWhereTheViewsShowNothing) {
  const auto view = std::make_shared<const RoundView>(2.0);
  const std::vector<LocalConstellation::PlacedView> views{{{}, view}, {{}, view}};
  Constellation map(2);
  map[0].position_m = {1.0, 0.0};
  map[1].position_m = {3.0, 0.0};
  EXPECT_EQ(missingLandmarksLogLikelihood(map, {true, true}, {}, views),
            -2.0);  // one is looked through
  EXPECT_EQ(missingLandmarksLogLikelihood(map, {true, false}, {}, views),
            -2.5);  // the other is overlooked, too
  EXPECT_EQ(missingLandmarksLogLikelihood(map, {true, true}, {-5.0, 0.0, 0.0}, views), 0.0);
}

}  // namespace
}  // namespace ram_slam
