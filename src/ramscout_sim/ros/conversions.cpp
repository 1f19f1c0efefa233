// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/conversions.hpp"

#include <array>

namespace ramscout_sim_ros {
namespace {

geometry_msgs::Pose toPose(const Eigen::Isometry3d& isometry) {
  const Eigen::Quaterniond q(isometry.linear());
  geometry_msgs::Pose pose;
  pose.position.x = isometry.translation().x();
  pose.position.y = isometry.translation().y();
  pose.position.z = isometry.translation().z();
  pose.orientation.w = q.w();
  pose.orientation.x = q.x();
  pose.orientation.y = q.y();
  pose.orientation.z = q.z();
  return pose;
}

}  // namespace

ros::Time toRosTime(std::int64_t stamp_ns) {
  ros::Time time;
  return time.fromNSec(static_cast<std::uint64_t>(stamp_ns));
}

sensor_msgs::LaserScan toMessage(const ramscout_sim::Scan& scan,
                                 const ramscout_sim::LidarParameters& lidar,
                                 const std::string& frame) {
  sensor_msgs::LaserScan message;
  message.header.stamp = toRosTime(scan.stamp_ns);
  message.header.frame_id = frame;
  message.angle_min = static_cast<float>(lidar.angle_min_rad);
  message.angle_max = static_cast<float>(lidar.angle_max_rad);
  message.angle_increment = static_cast<float>(lidar.angleIncrement_rad());
  message.time_increment = static_cast<float>(lidar.time_increment_s);
  message.scan_time = static_cast<float>(1.0 / lidar.scan_rate_hz);
  message.range_min = static_cast<float>(lidar.range_min_m);
  message.range_max = static_cast<float>(lidar.range_max_m);
  message.ranges = scan.ranges_m;
  return message;
}

nav_msgs::Odometry toMessage(const ramscout_sim::OdometryReading& reading,
                             const std::string& base_frame) {
  constexpr std::array<std::size_t, 3> kPlanar = {0, 1, 5};  // x, y, yaw among x y z roll pitch yaw
  constexpr double kUnmeasured = 1e-6;                       // the floor holds z, roll and pitch
  nav_msgs::Odometry message;
  message.header.stamp = toRosTime(reading.stamp_ns);
  message.header.frame_id = "odom";
  message.child_frame_id = base_frame;
  message.pose.pose = toPose(ramscout_sim::toIsometry(reading.odom_from_base));
  message.twist.twist.linear.x = reading.twist.forward_mps;
  message.twist.twist.linear.y = reading.twist.left_mps;
  message.twist.twist.angular.z = reading.twist.turn_radps;
  for (std::size_t i = 0; i < 6; ++i) {
    message.pose.covariance[7 * i] = kUnmeasured;
    message.twist.covariance[7 * i] = kUnmeasured;
  }
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      message.pose.covariance[6 * kPlanar[row] + kPlanar[column]] =
          reading.covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      const double variance = reading.twist_covariance(static_cast<Eigen::Index>(row),
                                                       static_cast<Eigen::Index>(column));
      if (row != column || variance > 0.0)
        message.twist.covariance[6 * kPlanar[row] + kPlanar[column]] = variance;
    }
  }
  return message;
}

nav_msgs::Odometry toMessage(const ramscout_sim::GroundTruth& truth,
                             const std::string& base_frame) {
  nav_msgs::Odometry message;
  message.header.stamp = toRosTime(truth.stamp_ns);
  message.header.frame_id = "world";
  message.child_frame_id = base_frame;
  message.pose.pose = toPose(truth.world_from_base);
  message.twist.twist.linear.x = truth.linear_velocity_mps.x();
  message.twist.twist.linear.y = truth.linear_velocity_mps.y();
  message.twist.twist.linear.z = truth.linear_velocity_mps.z();
  message.twist.twist.angular.x = truth.angular_velocity_radps.x();
  message.twist.twist.angular.y = truth.angular_velocity_radps.y();
  message.twist.twist.angular.z = truth.angular_velocity_radps.z();
  return message;
}

geometry_msgs::TransformStamped toTransform(const nav_msgs::Odometry& odometry) {
  geometry_msgs::TransformStamped transform;
  transform.header = odometry.header;
  transform.child_frame_id = odometry.child_frame_id;
  transform.transform.translation.x = odometry.pose.pose.position.x;
  transform.transform.translation.y = odometry.pose.pose.position.y;
  transform.transform.translation.z = odometry.pose.pose.position.z;
  transform.transform.rotation = odometry.pose.pose.orientation;
  return transform;
}

sensor_msgs::JointState toJointState(const ramscout_sim::OdometryReading& reading,
                                     const ramscout_sim::RobotDescription& robot) {
  sensor_msgs::JointState message;
  message.header.stamp = toRosTime(reading.stamp_ns);
  for (std::size_t i = 0; i < robot.wheels.size(); ++i) {
    const ramscout_sim::Wheel& wheel = robot.wheels[i];
    message.name.push_back(wheel.joint);
    message.position.push_back(reading.wheel_angles_rad[i]);
    message.velocity.push_back(reading.wheel_speeds_radps[i]);
    if (!wheel.steering) continue;
    message.name.push_back(wheel.steering->joint);
    message.position.push_back(reading.steering_rad[i]);
    message.velocity.push_back(0.0);
  }
  return message;
}

}  // namespace ramscout_sim_ros
