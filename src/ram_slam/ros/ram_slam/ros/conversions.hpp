// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/Transform.h>
#include <nav_msgs/Odometry.h>
#include <ram_slam_msgs/FeatureList.h>
#include <ram_slam_msgs/LidarCalibration.h>
#include <ram_slam_msgs/Tracking.h>
#include <ros/time.h>
#include <sensor_msgs/LaserScan.h>

#include "ram_slam/calibration/lidar_calibration.hpp"
#include "ram_slam/estimation/estimator.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/sensing/laser_scan.hpp"

namespace ram_slam_ros {

std::int64_t toNanoseconds(const ros::Time& time);
/// Stamps before 1970 become zero.
ros::Time toTime(std::int64_t stamp_ns);

/// The planar part of a pose or transform.
/// \throws std::invalid_argument if a value is not finite or the quaternion's norm differs from 1
/// by more than 1e-3
ram_slam::Pose2 toPose2(const geometry_msgs::Pose& message);
ram_slam::Pose2 toPose2(const geometry_msgs::Transform& message);

geometry_msgs::Pose toPoseMessage(const ram_slam::Pose2& pose);
geometry_msgs::Transform toTransformMessage(const ram_slam::Pose2& pose);

/// The planar part and its covariance. \throws std::invalid_argument as toPose2, or if an entry is
/// not finite
ram_slam::PoseWithCovariance2 toPoseWithCovariance2(
    const geometry_msgs::PoseWithCovariance& message);
/// z, roll and pitch are zero with variance 1e6: not known.
geometry_msgs::PoseWithCovariance toPoseWithCovarianceMessage(
    const ram_slam::PoseWithCovariance2& pose);

/// \throws std::invalid_argument if it is in another frame than the map's, or as toPose2()
ram_slam::Tracking toTracking(const ram_slam_msgs::Tracking& message, const std::string& map_frame);

/// Whether odometry is that of these frames; a frame without a name is any.
/// \throws std::invalid_argument that names all four and what to set
void requireFrames(const nav_msgs::Odometry& message,
                   const std::string& odom_frame,
                   const std::string& base_frame);

/// Time that a scan's beams take by its time_increment [s].
double sweep_s(const sensor_msgs::LaserScan& message);
/// Whether a lidar can take that long: longer than zero and at most 1 s.
bool isPlausibleSweep(double sweep_s);
/// Whether range_max is a limit: not zero, infinite or farther than any lidar sees.
bool hasRangeLimit(const sensor_msgs::LaserScan& message);
/// Finite readings at range_max or farther; zero if that is no limit.
std::size_t countAtLimit(const sensor_msgs::LaserScan& message);

/// Readings at range_max mean that nothing came back; readings of less than 1 mm are no
/// information. Without a range limit LaserScan::kUnlimitedRangeM stands for it; a time_increment
/// that cannot be true counts as zero.
/// \throws std::invalid_argument as LaserScan::validate(), or if the stamp is zero
ram_slam::LaserScan toLaserScan(const sensor_msgs::LaserScan& message);
/// The same scan as it is, without a frame.
sensor_msgs::LaserScan toScanMessage(const ram_slam::LaserScan& scan);

/// What is added to the time of a mirror turn.
/// \throws std::invalid_argument if it is not finite or no lidar can be so far off: 1 s
double toAddedMirrorTurn_s(const ram_slam_msgs::LidarCalibration& message);
ram_slam_msgs::LidarCalibration toLidarMessage(const ram_slam::LidarCalibration& calibration);

/// A feature's position covariance must be finite, symmetric and positive definite, the variance of
/// its orientation positive.
/// \throws std::invalid_argument with the reason
ram_slam::Feature toFeature(const ram_slam_msgs::Feature& message);
ram_slam_msgs::Feature toFeatureMessage(const ram_slam::Feature& feature,
                                        const std_msgs::Header& header);

/// Features that toFeature() refuses are left out and counted.
struct CheckedFeatures {
  ram_slam::FeatureList list;
  int rejected_count = 0;
};
/// \throws std::invalid_argument if they are in another frame or the stamp is zero
CheckedFeatures toFeatureList(const ram_slam_msgs::FeatureList& message,
                              const std::string& frame_id);
ram_slam_msgs::FeatureList toFeatureListMessage(const ram_slam::FeatureList& list,
                                                const std::string& frame_id);

}  // namespace ram_slam_ros
