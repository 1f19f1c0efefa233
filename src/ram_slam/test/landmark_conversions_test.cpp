// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/landmark_conversions.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ram_slam/ros/conversions.hpp"

namespace ram_slam_ros {
namespace {

using ram_slam::LandmarkEstimate;
using testing::HasSubstr;

/// Two correlated landmarks; the ellipse of the second one is 0.3 m by 0.1 m, turned by 0.5 rad.
ram_slam::LandmarkMap exampleMap() {
  ram_slam::LandmarkMap map;
  map.stamp_ns = 5'000'000'001;
  LandmarkEstimate first;
  first.id = 3;
  first.type = "corner";
  first.classifier = "pg1:abc";
  first.mean_m = {1.0, -2.0};
  first.covariance_m2 << 0.04, 0.01, 0.01, 0.09;
  first.existence_log_odds = 2.5;
  first.orientation_rad = -0.75;
  first.orientation_variance_rad2 = 0.01;
  LandmarkEstimate second;
  second.id = 8;
  second.type = "pole";
  second.mean_m = {4.0, 5.0};
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.5).toRotationMatrix();
  second.covariance_m2 = turn * Eigen::Vector2d(0.09, 0.01).asDiagonal() * turn.transpose();
  second.existence_log_odds = -1.0;
  map.landmarks = {first, second};
  ram_slam::LandmarkCovariance block;
  block.first_id = 3;
  block.second_id = 8;
  block.covariance_m2 << 1e-3, 2e-3, 3e-3, 4e-3;
  map.covariances = {block};
  return map;
}

TEST(LandmarkConversions, LandmarksReadBackAsTheyWere) {
  const auto back = toLandmarkEstimates(toLandmarkMapMessage(exampleMap(), "map"), "map");
  ASSERT_EQ(back.size(), 2u);
  for (std::size_t i = 0; i < back.size(); ++i) {
    const LandmarkEstimate expected = exampleMap().landmarks[i];
    EXPECT_EQ(back[i].id, expected.id);
    EXPECT_EQ(back[i].type, expected.type);
    EXPECT_EQ(back[i].classifier, expected.classifier);
    EXPECT_EQ(back[i].mean_m, expected.mean_m);
    EXPECT_EQ(back[i].covariance_m2, expected.covariance_m2);
    EXPECT_EQ(back[i].existence_log_odds, expected.existence_log_odds);
    EXPECT_NEAR(back[i].orientation_rad, expected.orientation_rad, 1e-15);
    EXPECT_EQ(back[i].orientation_variance_rad2, expected.orientation_variance_rad2);
  }
}

TEST(LandmarkConversions, TheMessageHasTheStampAndFrameOfTheMapEverywhere) {
  const auto message = toLandmarkMapMessage(exampleMap(), "map");
  EXPECT_EQ(toNanoseconds(message.header.stamp), 5'000'000'001);
  EXPECT_EQ(message.header.frame_id, "map");
  for (const auto& landmark : message.landmarks) EXPECT_EQ(landmark.feature.header, message.header);
}

TEST(LandmarkConversions, ABlockOfTheCovarianceIsTheUpperLeftOneOfThreeByThree) {
  const auto message = toLandmarkMapMessage(exampleMap(), "map");
  ASSERT_EQ(message.covariances.size(), 1u);
  EXPECT_EQ(message.covariances[0].first_id, 3u);
  EXPECT_EQ(message.covariances[0].second_id, 8u);
  EXPECT_THAT(message.covariances[0].covariance,
              testing::ElementsAre(1e-3, 2e-3, 0.0, 3e-3, 4e-3, 0.0, 0.0, 0.0, 0.0));
}

TEST(LandmarkConversions, LandmarksOfAnotherFrameAreRefusedByBothNames) {
  try {
    toLandmarkEstimates(toLandmarkMapMessage(exampleMap(), "odom"), "map");
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("'odom' instead of 'map'"));
  }
}

TEST(LandmarkConversions, ALandmarkWithoutAUsableCovarianceRefusesTheMap) {
  auto message = toLandmarkMapMessage(exampleMap(), "map");
  message.landmarks[1].feature.pose.covariance[0] = -0.1;
  EXPECT_THROW(toLandmarkEstimates(message, "map"), std::invalid_argument);
}

TEST(LandmarkMarkers, ReplaceAllEarlierOnesByAnEllipseEach) {
  const auto markers = toMarkers(exampleMap(), "map", {}).markers;
  ASSERT_EQ(markers.size(), 3u);
  EXPECT_EQ(markers[0].action, visualization_msgs::Marker::DELETEALL);
  EXPECT_EQ(markers[1].id, 3);
  EXPECT_EQ(markers[2].id, 8);
  for (const auto& marker : markers) EXPECT_EQ(marker.header.frame_id, "map");
}

TEST(LandmarkMarkers, EllipseHasTheAxesOfTheCovariance) {
  ram_slam::LandmarkMarkerParameters parameters;
  parameters.ellipse_sigmas = 2.0;
  const auto marker = toMarkers(exampleMap(), "map", parameters).markers[2];
  EXPECT_NEAR(marker.scale.x, 2.0 * 2.0 * 0.3, 1e-12);
  EXPECT_NEAR(marker.scale.y, 2.0 * 2.0 * 0.1, 1e-12);
  const ram_slam::Pose2 pose = toPose2(marker.pose);
  EXPECT_EQ(pose.x_m, 4.0);
  EXPECT_NEAR(std::sin(pose.yaw_rad - 0.5), 0.0, 1e-12) << "an axis has no direction";
}

TEST(LandmarkMarkers, AnEllipseIsNeverThinnerThanCanBeSeen) {
  ram_slam::LandmarkMap map = exampleMap();
  map.landmarks[0].covariance_m2 = 1e-12 * Eigen::Matrix2d::Identity();
  ram_slam::LandmarkMarkerParameters parameters;
  parameters.least_diameter_m = 0.07;
  const auto marker = toMarkers(map, "map", parameters).markers[1];
  EXPECT_EQ(marker.scale.x, 0.07);
  EXPECT_EQ(marker.scale.y, 0.07);
}

TEST(LandmarkMarkers, DoubtfulLandmarksAreFainter) {
  const auto markers = toMarkers(exampleMap(), "map", {}).markers;
  EXPECT_GT(markers[1].color.a, 2.0F * markers[2].color.a);
}

}  // namespace
}  // namespace ram_slam_ros
