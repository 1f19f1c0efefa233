// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>

#include "ramscout_sim/simulation.hpp"

namespace ramscout_sim_ros {

ros::Time toRosTime(std::int64_t stamp_ns);

/// \param frame  of the laser
sensor_msgs::LaserScan toMessage(const ramscout_sim::Scan& scan,
                                 const ramscout_sim::LidarParameters& lidar,
                                 const std::string& frame);

/// Frame `odom`, child the base.
nav_msgs::Odometry toMessage(const ramscout_sim::OdometryReading& reading,
                             const std::string& base_frame);

/// Frame `world`, child the base.
nav_msgs::Odometry toMessage(const ramscout_sim::GroundTruth& truth, const std::string& base_frame);

/// The transform odom -> base of the same reading.
geometry_msgs::TransformStamped toTransform(const nav_msgs::Odometry& odometry);

/// All wheels and what steers them.
sensor_msgs::JointState toJointState(const ramscout_sim::OdometryReading& reading,
                                     const ramscout_sim::RobotDescription& robot);

}  // namespace ramscout_sim_ros
