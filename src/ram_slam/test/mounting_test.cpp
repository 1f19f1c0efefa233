// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/mounting.hpp"

#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam_ros {
namespace {

geometry_msgs::Transform transformOf(double roll_rad, double pitch_rad, double yaw_rad) {
  const Eigen::Quaterniond q = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
  geometry_msgs::Transform transform;
  transform.translation.x = 0.2;
  transform.translation.y = -0.1;
  transform.rotation.x = q.x();
  transform.rotation.y = q.y();
  transform.rotation.z = q.z();
  transform.rotation.w = q.w();
  return transform;
}

TEST(Mounting, UprightKeepsItsYaw) {
  const Mounting mounting = toMounting(transformOf(0.0, 0.05, 2.0));
  EXPECT_FALSE(mounting.upside_down);
  EXPECT_NEAR(mounting.base_from_sensor.yaw_rad, 2.0, 1e-6);
  EXPECT_EQ(mounting.base_from_sensor.x_m, 0.2);
}

TEST(Mounting, UpsideDownMirroredBeamPointsWhereTheTransformSaysItDoes) {
  const Mounting mounting = toMounting(transformOf(M_PI, 0.0, 0.7));
  ASSERT_TRUE(mounting.upside_down);
  ram_slam::LaserScan scan;
  scan.angle_min_rad = 0.3;
  scan.angle_increment_rad = 0.1;
  scan.range_max_m = 10.0F;
  scan.ranges_m = {2.0F};
  const Eigen::Vector2d planar = mounting.base_from_sensor * ram_slam::mirrored(scan).end_m(0);

  const auto q = transformOf(M_PI, 0.0, 0.7).rotation;
  const Eigen::Vector3d spatial =
      Eigen::Vector3d(0.2, -0.1, 0.0) +
      Eigen::Quaterniond(q.w, q.x, q.y, q.z) *
          Eigen::Vector3d(2.0 * std::cos(0.3), 2.0 * std::sin(0.3), 0.0);
  EXPECT_NEAR(planar.x(), spatial.x(), 1e-12);
  EXPECT_NEAR(planar.y(), spatial.y(), 1e-12);
}

TEST(Mounting, TiltedSensorIsRefused) {
  EXPECT_THROW(toMounting(transformOf(0.5, 0.0, 0.0)), std::invalid_argument);
  EXPECT_THROW(toMounting(geometry_msgs::Transform()), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam_ros
