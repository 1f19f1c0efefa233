// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/landmark_layer.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

LandmarkMap mapOfOne() {
  LandmarkEstimate landmark;
  landmark.id = 7;
  landmark.type = "corner";
  landmark.classifier = "pg1:x";
  landmark.mean_m = {1.5, -2.0};
  landmark.covariance_m2 << 0.04, 0.01, 0.01, 0.09;
  landmark.existence_log_odds = 3.0;
  landmark.orientation_rad = 2.5;
  landmark.orientation_variance_rad2 = 0.02;
  landmark.placed_ns = 123;
  LandmarkMap map;
  map.stamp_ns = 456;
  map.landmarks = {landmark};
  return map;
}

TEST(LandmarkLayer, HoldsThePlanarLandmarkInSpace) {
  const LandmarkLayer layer = toLandmarkLayer(mapOfOne());
  EXPECT_EQ(layer.stamp_ns, 456);
  ASSERT_EQ(layer.landmarks.size(), 1U);
  const WorldLandmark& landmark = layer.landmarks[0];
  EXPECT_EQ(landmark.id, 7U);
  EXPECT_EQ(landmark.stamp_ns, 123);
  EXPECT_EQ(landmark.pose.position_m, Eigen::Vector3d(1.5, -2.0, 0.0));
  EXPECT_NEAR(landmark.pose.planar().yaw_rad, 2.5, 1e-12);
  EXPECT_EQ(landmark.pose.covariance(0, 1), 0.01);
  EXPECT_EQ(landmark.pose.covariance(5, 5), 0.02);
  for (const int unknown : {2, 3, 4})
    EXPECT_EQ(landmark.pose.covariance(unknown, unknown), SpatialPose::kUnknownVariance);
}

TEST(LandmarkLayer, GivesBackTheLandmarkButForItsFirstStamp) {
  const LandmarkMap map = mapOfOne();
  const LandmarkMap back = toLandmarkMap(toLandmarkLayer(map));
  EXPECT_EQ(back.stamp_ns, map.stamp_ns);
  ASSERT_EQ(back.landmarks.size(), 1U);
  const LandmarkEstimate& before = map.landmarks[0];
  const LandmarkEstimate& after = back.landmarks[0];
  EXPECT_EQ(after.id, before.id);
  EXPECT_EQ(after.type, before.type);
  EXPECT_EQ(after.classifier, before.classifier);
  EXPECT_EQ(after.mean_m, before.mean_m);
  EXPECT_EQ(after.covariance_m2, before.covariance_m2);
  EXPECT_EQ(after.existence_log_odds, before.existence_log_odds);
  EXPECT_NEAR(after.orientation_rad, before.orientation_rad, 1e-12);
  EXPECT_EQ(after.orientation_variance_rad2, before.orientation_variance_rad2);
  EXPECT_EQ(after.placed_ns, 0);
}

TEST(LandmarkLayer, OfAnEmptyMapIsEmpty) {
  EXPECT_TRUE(toLandmarkLayer({}).landmarks.empty());
  EXPECT_TRUE(toLandmarkMap({}).landmarks.empty());
}

}  // namespace
}  // namespace ram_slam
