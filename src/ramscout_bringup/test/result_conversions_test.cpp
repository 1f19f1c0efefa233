// SPDX-License-Identifier: BSD-3-Clause
#include "../ros/result_conversions.hpp"

#include <stdexcept>

#include <gmock/gmock.h>
#include <ram_slam/ros/conversions.hpp>

namespace ramscout_bringup_ros {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

nav_msgs::OccupancyGrid exampleGrid() {
  nav_msgs::OccupancyGrid message;
  message.info.resolution = 0.25F;
  message.info.width = 3;
  message.info.height = 2;
  message.info.origin = ram_slam_ros::toPoseMessage({-1.0, 2.0, 0.5});
  message.data = {0, 100, -1, 0, 0, 50};
  return message;
}

TEST(ResultConversions, AGridKeepsItsPlaceItsSizeAndItsCells) {
  const ram_slam::OccupancyGrid grid = toOccupancyGrid(exampleGrid());
  EXPECT_EQ(grid.resolution_m, 0.25);
  EXPECT_EQ(grid.width, 3);
  EXPECT_EQ(grid.height, 2);
  EXPECT_EQ(grid.cells, exampleGrid().data);
  EXPECT_EQ(grid.map_from_grid.x_m, -1.0);
  EXPECT_NEAR(grid.map_from_grid.yaw_rad, 0.5, 1e-15);
}

TEST(ResultConversions, AGridWithoutAllItsCellsIsRefusedByItsNumbers) {
  nav_msgs::OccupancyGrid message = exampleGrid();
  message.data.pop_back();
  EXPECT_THAT([&] { toOccupancyGrid(message); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("5 cells instead of 3 x 2")));
}

TEST(ResultConversions, APathIsReadAtTheStampsOfItsPoses) {
  nav_msgs::Path path;
  path.header.stamp = ros::Time(99, 0);
  for (const std::uint32_t second : {1u, 2u}) {
    geometry_msgs::PoseStamped pose;
    pose.header.stamp = ros::Time(second, 7);
    pose.pose = ram_slam_ros::toPoseMessage({0.5 * second, -1.0, 0.25});
    path.poses.push_back(pose);
  }
  const ramscout_bringup::Trajectory trajectory = toTrajectory(path);
  ASSERT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(trajectory[1].stamp_ns, 2'000'000'007);
  EXPECT_EQ(trajectory[1].pose.x_m, 1.0);
  EXPECT_TRUE(toTrajectory(nav_msgs::Path()).empty());
}

TEST(ResultConversions, LandmarksKeepTheirPlaceAndItsCovariance) {
  ram_slam::Feature feature;
  feature.type = "corner";
  feature.classifier = "pg1:x";
  feature.position_m = {3.0, 4.0};
  feature.covariance_m2 << 0.04, 0.01, 0.01, 0.09;
  ram_slam_msgs::LandmarkMap message;
  message.landmarks.resize(1);
  message.landmarks[0].id = 17;
  message.landmarks[0].existence_log_odds = 1.5;
  message.landmarks[0].feature = ram_slam_ros::toFeatureMessage(feature, message.header);
  const auto landmarks = toMapLandmarks(message);
  ASSERT_EQ(landmarks.size(), 1u);
  EXPECT_EQ(landmarks[0].id, 17u);
  EXPECT_EQ(landmarks[0].type, "corner");
  EXPECT_EQ(landmarks[0].classifier, "pg1:x");
  EXPECT_EQ(landmarks[0].position_m, feature.position_m);
  EXPECT_EQ(landmarks[0].covariance_m2, feature.covariance_m2);
  EXPECT_EQ(landmarks[0].existence_log_odds, 1.5);
}

}  // namespace
}  // namespace ramscout_bringup_ros
