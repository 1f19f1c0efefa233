// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/occupancy_conversions.hpp"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ram_slam/ros/conversions.hpp"

namespace ram_slam_ros {
namespace {

ram_slam::OccupancyGrid exampleGrid() {
  ram_slam::OccupancyGrid grid;
  grid.map_from_grid = {-3.2, 6.4, 0.5};
  grid.width = 3;
  grid.height = 2;
  grid.cells = {100, 0, -1, 50, 0, 1};
  return grid;
}

TEST(OccupancyConversions, GridRoundTripKeepsOriginRotationAndCells) {
  const nav_msgs::OccupancyGrid message = toOccupancyGridMessage(exampleGrid(), "map", 1500000000);
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_EQ(message.header.stamp, ros::Time(1, 500000000));
  const ram_slam::OccupancyGrid back = toOccupancyGrid(message);
  EXPECT_EQ(back.cells, exampleGrid().cells);
  EXPECT_EQ(back.width, 3);
  EXPECT_EQ(back.resolution_m, 0.05);
  EXPECT_NEAR(back.map_from_grid.yaw_rad, 0.5, 1e-12);
}

TEST(OccupancyConversions, UpdateHasTheCellsOfTheChangeOnly) {
  const auto update = toUpdateMessage(exampleGrid(), {false, 1, 0, 2, 2}, "map", 1);
  EXPECT_EQ(update.x, 1);
  EXPECT_EQ(update.width, 2u);
  EXPECT_THAT(update.data, testing::ElementsAre(0, -1, 0, 1));
}

TEST(OccupancyConversions, GridsThatContradictThemselvesAreRefused) {
  const nav_msgs::OccupancyGrid good = toOccupancyGridMessage(exampleGrid(), "map", 1);
  nav_msgs::OccupancyGrid bad = good;
  bad.data.pop_back();
  EXPECT_THROW(toOccupancyGrid(bad), std::invalid_argument);
  bad = good;
  bad.data[0] = 101;
  EXPECT_THROW(toOccupancyGrid(bad), std::invalid_argument);
  bad.data[0] = -2;
  EXPECT_THROW(toOccupancyGrid(bad), std::invalid_argument);
  for (const float resolution : {0.0F, -0.05F, std::numeric_limits<float>::quiet_NaN()}) {
    bad = good;
    bad.info.resolution = resolution;
    EXPECT_THROW(toOccupancyGrid(bad), std::invalid_argument) << resolution;
  }
  bad = good;
  bad.info.origin.orientation.w = 0.0;
  EXPECT_THROW(toOccupancyGrid(bad), std::invalid_argument);
}

TEST(OccupancyConversions, PathIsReadAtTheStampsOfItsPoses) {
  nav_msgs::Path path;
  path.header.stamp = ros::Time(99, 0);
  path.poses.resize(2);
  for (auto& pose : path.poses) pose.pose = toPoseMessage({1.0, 2.0, 3.0});
  path.poses[0].header.stamp = ros::Time(1, 5);
  path.poses[1].header.stamp = ros::Time(2, 0);
  const ram_slam::Trajectory trajectory = toTrajectory(path);
  ASSERT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(trajectory[0].stamp_ns, 1000000005);
  EXPECT_EQ(trajectory[0].pose.y_m, 2.0);
  path.poses[1].header.stamp = ros::Time(1, 5);
  EXPECT_THROW(toTrajectory(path), std::invalid_argument);
}

TEST(PathConversions, ATrajectoryReadsBackFromItsPath) {
  const ram_slam::Trajectory trajectory{{1'000'000'001, {1.0, -2.0, 0.5}},
                                        {2'500'000'000, {3.0, 4.0, -3.0}}};
  const nav_msgs::Path path = toPath(trajectory, "map");
  EXPECT_EQ(path.header.frame_id, "map");
  EXPECT_EQ(path.header.stamp, ros::Time(2, 500'000'000));
  const ram_slam::Trajectory back = toTrajectory(path);
  ASSERT_EQ(back.size(), trajectory.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].stamp_ns, trajectory[i].stamp_ns);
    EXPECT_NEAR(back[i].pose.x_m, trajectory[i].pose.x_m, 1e-12);
    EXPECT_NEAR(back[i].pose.yaw_rad, trajectory[i].pose.yaw_rad, 1e-12);
  }
}

TEST(KeyScanMessage, GivesBackTheSameNumbers) {
  ram_slam::PlacedScan placed;
  placed.scan.stamp_ns = 1'000'000'007;
  placed.scan.angle_min_rad = -1.5F;
  placed.scan.angle_increment_rad = 0.01F;
  placed.scan.time_increment_s = 1e-4F;
  placed.scan.range_min_m = 0.1F;
  placed.scan.range_max_m = 5.0F;
  placed.scan.ranges_m = {1.0F, 4.999F, std::numeric_limits<float>::infinity()};
  placed.base_from_laser = {0.1, 0.2, 0.3};
  placed.map_from_laser = {1.0 / 3.0, -2.0 / 3.0, 3.1};
  placed.last_beam = {0.001, 0.0, 0.002};
  const ram_slam::PlacedScan back = toPlacedScan(toKeyScanMessage(placed));
  EXPECT_EQ(back.scan.stamp_ns, placed.scan.stamp_ns);
  EXPECT_EQ(back.scan.angle_min_rad, placed.scan.angle_min_rad);
  EXPECT_EQ(back.scan.angle_increment_rad, placed.scan.angle_increment_rad);
  EXPECT_EQ(back.scan.time_increment_s, placed.scan.time_increment_s);
  EXPECT_EQ(back.scan.ranges_m, placed.scan.ranges_m);
  EXPECT_EQ(back.map_from_laser.x_m, placed.map_from_laser.x_m);
  EXPECT_EQ(back.map_from_laser.yaw_rad, placed.map_from_laser.yaw_rad);
  EXPECT_EQ(back.last_beam.yaw_rad, placed.last_beam.yaw_rad);
  EXPECT_EQ(back.base_from_laser.y_m, placed.base_from_laser.y_m);
}

}  // namespace
}  // namespace ram_slam_ros
