// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/relocaliser.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "rooms.hpp"

namespace ram_slam {
namespace {

/// A lost robot that drives past poles in a room.
class Relocalising : public testing::Test {
protected:
  static ConstellationPoint pole(double x_m, double y_m) {
    ConstellationPoint point;
    point.type = "pole";
    point.position_m = {x_m, y_m};
    point.covariance_m2 = 1e-4 * Eigen::Matrix2d::Identity();
    return point;
  }

  /// \param carried  the robot is not where odometry has led it
  void drive(double way_m, const Pose2& carried = {}) {
    truth_ = truth_ * carried;
    for (double left_m = way_m; left_m > 1e-9; left_m -= 0.1) {
      const Pose2 step{0.1, 0.0, 0.0};
      truth_ = truth_ * step;
      local_from_base_ = local_from_base_ * step;
      FeatureList list;
      list.stamp_ns = 1;
      for (const ConstellationPoint& point : poles_) {
        Feature feature;
        feature.type = "pole";
        feature.position_m = truth_.inverse() * point.position_m;
        feature.covariance_m2 = point.covariance_m2;
        if (feature.position_m.norm() < 5.0) list.features.push_back(feature);
      }
      relocaliser_.add(list, step, viewIn(room_, truth_));
    }
  }

  std::optional<PoseWithCovariance2> search() {
    return relocaliser_.search({poles_, map_views_, std::nullopt, local_from_base_});
  }

  const Walls room_ = oddRoom();
  const MapViews map_views_ = viewsOf(room_);
  const Constellation poles_{pole(8.5, 0.0), pole(10.0, 3.0), pole(11.5, 0.0),
                             pole(9.0, 3.0), pole(10.5, 0.0), pole(7.5, 3.0)};
  Pose2 truth_{6.0, 1.4, 0.0};
  Pose2 local_from_base_;
  Relocaliser relocaliser_{RelocaliserParameters{}, {}};
};

TEST_F(Relocalising, FindsAPlaceWhenTwoTriesAgree) {
  drive(3.0);
  ASSERT_TRUE(relocaliser_.isDue());
  EXPECT_FALSE(search());  // one try is not enough
  EXPECT_FALSE(relocaliser_.isDue());
  drive(0.6);
  ASSERT_TRUE(relocaliser_.isDue());
  const auto place = search();
  ASSERT_TRUE(place);
  EXPECT_PRED2(isNear, place->pose, truth_);
}

TEST_F(Relocalising, TriesAgainAfterHalfAMetre) {
  drive(0.4);
  EXPECT_FALSE(relocaliser_.isDue());
  drive(0.2);
  EXPECT_TRUE(relocaliser_.isDue());
  search();
  drive(0.4);
  EXPECT_FALSE(relocaliser_.isDue());
  drive(0.2);
  EXPECT_TRUE(relocaliser_.isDue());
  EXPECT_NEAR(relocaliser_.distance_m(), 1.2, 1e-9);
}

TEST_F(Relocalising, FindsNothingWithoutFeatures) {
  EXPECT_FALSE(search());
  EXPECT_FALSE(search());
}

TEST_F(Relocalising, DoesNotTakeTwoTriesThatDifferForOnePlace) {
  drive(3.0);
  EXPECT_FALSE(search());
  // In the frame of odometry the same place of the map is elsewhere now.
  local_from_base_ = local_from_base_ * Pose2{1.0, 0.0, 0.0};
  EXPECT_FALSE(search());
  EXPECT_TRUE(search());
}

TEST(RelocaliserParameters, RefuseNoDistanceBetweenTries) {
  RelocaliserParameters parameters;
  parameters.try_every_m = 0.0;
  EXPECT_THROW(Relocaliser(parameters, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
