// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ros/conversions.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam_ros {
namespace {

constexpr std::size_t kMaxFeatures = 1000;
constexpr double kLongestSweepS = 1.0;      // a longer one is no sweep but nonsense
constexpr float kLeastRangeM = 0.001F;      // drivers that count millimetres put 0 for "no reading"
constexpr float kFarthestRangeM = 1000.0F;  // no lidar on a robot: the driver names no limit
constexpr float kLimitShare = 1.0F - 1e-4F;  // range_max, as far as floats and millimetres resolve
constexpr double kSymmetryTolerance = 1e-6;
constexpr int kPlanar[] = {0, 1, 5};                 // x, y and yaw among x, y, z, roll, pitch, yaw
constexpr std::int64_t kMaxDelayNs = 1'000'000'000;  // of a feature after its list

ram_slam::Pose2 toPose2(double x, double y, const geometry_msgs::Quaternion& q) {
  const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!std::isfinite(x) || !std::isfinite(y) ||
      !(std::abs(norm - 1.0) <= ram_slam::SpatialPose::kQuaternionTolerance)) {
    throw std::invalid_argument("pose is not finite or its quaternion (norm " +
                                std::to_string(norm) + ") is not a rotation");
  }
  const ram_slam::Pose2 pose{
      x, y, std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))};
  if (!pose.isUsable()) throw std::invalid_argument("pose is farther off than 10,000 km");
  return pose;
}

geometry_msgs::Quaternion toQuaternion(double yaw_rad) {
  geometry_msgs::Quaternion q;
  q.z = std::sin(yaw_rad / 2.0);
  q.w = std::cos(yaw_rad / 2.0);
  return q;
}

/// 0 if the feature has no stamp of its own.
/// \throws std::invalid_argument if it is too far from the list's
std::int64_t delayOf(const ros::Time& stamp, std::int64_t list_stamp_ns) {
  if (stamp.isZero()) return 0;
  const std::int64_t delay_ns = toNanoseconds(stamp) - list_stamp_ns;
  if (delay_ns < -kMaxDelayNs || delay_ns > kMaxDelayNs)
    throw std::invalid_argument("a feature's stamp is more than 1 s from its list's");
  return delay_ns;
}

}  // namespace

std::int64_t toNanoseconds(const ros::Time& time) {
  return static_cast<std::int64_t>(time.sec) * 1000000000 + static_cast<std::int64_t>(time.nsec);
}

ros::Time toTime(std::int64_t stamp_ns) {
  ros::Time time;
  if (stamp_ns > 0) time.fromNSec(static_cast<std::uint64_t>(stamp_ns));
  return time;
}

ram_slam::Pose2 toPose2(const geometry_msgs::Pose& message) {
  return toPose2(message.position.x, message.position.y, message.orientation);
}

ram_slam::Pose2 toPose2(const geometry_msgs::Transform& message) {
  return toPose2(message.translation.x, message.translation.y, message.rotation);
}

geometry_msgs::Pose toPoseMessage(const ram_slam::Pose2& pose) {
  geometry_msgs::Pose message;
  message.position.x = pose.x_m;
  message.position.y = pose.y_m;
  message.orientation = toQuaternion(pose.yaw_rad);
  return message;
}

geometry_msgs::Transform toTransformMessage(const ram_slam::Pose2& pose) {
  geometry_msgs::Transform message;
  message.translation.x = pose.x_m;
  message.translation.y = pose.y_m;
  message.rotation = toQuaternion(pose.yaw_rad);
  return message;
}

ram_slam::PoseWithCovariance2 toPoseWithCovariance2(
    const geometry_msgs::PoseWithCovariance& message) {
  ram_slam::PoseWithCovariance2 pose;
  pose.pose = toPose2(message.pose);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      pose.covariance(row, column) = message.covariance[6 * kPlanar[row] + kPlanar[column]];
    }
  }
  constexpr double kMostVariance = ram_slam::kFarthest_m * ram_slam::kFarthest_m;
  if (!pose.covariance.allFinite() || pose.covariance.cwiseAbs().maxCoeff() > kMostVariance)
    throw std::invalid_argument("pose covariance is not finite or greater than 1e14");
  return pose;
}

geometry_msgs::PoseWithCovariance toPoseWithCovarianceMessage(
    const ram_slam::PoseWithCovariance2& pose) {
  geometry_msgs::PoseWithCovariance message;
  message.pose = toPoseMessage(pose.pose);
  for (int i = 2; i < 5; ++i) message.covariance[7 * i] = ram_slam::SpatialPose::kUnknownVariance;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      message.covariance[6 * kPlanar[row] + kPlanar[column]] = pose.covariance(row, column);
    }
  }
  return message;
}

void requireFrames(const nav_msgs::Odometry& message,
                   const std::string& odom_frame,
                   const std::string& base_frame) {
  const auto matches = [](const std::string& wanted, const std::string& got) {
    return got.empty() || wanted == got;
  };
  if (matches(odom_frame, message.header.frame_id) && matches(base_frame, message.child_frame_id))
    return;
  throw std::invalid_argument("it is of '" + message.child_frame_id + "' in '" +
                              message.header.frame_id + "', wanted '" + base_frame + "' in '" +
                              odom_frame + "': set odom_frame and base_frame");
}

double sweep_s(const sensor_msgs::LaserScan& message) {
  return static_cast<double>(message.time_increment) * static_cast<double>(message.ranges.size());
}

bool isPlausibleSweep(double sweep_s) {
  return sweep_s > 0.0 && sweep_s <= kLongestSweepS;
}

bool hasRangeLimit(const sensor_msgs::LaserScan& message) {
  return message.range_max != 0.0F && !(message.range_max > kFarthestRangeM);
}

std::size_t countAtLimit(const sensor_msgs::LaserScan& message) {
  if (!hasRangeLimit(message)) return 0;
  return static_cast<std::size_t>(
      std::count_if(message.ranges.begin(), message.ranges.end(), [&](float range_m) {
        return range_m >= kLimitShare * message.range_max && std::isfinite(range_m);
      }));
}

ram_slam::LaserScan toLaserScan(const sensor_msgs::LaserScan& message) {
  if (message.header.stamp.isZero()) throw std::invalid_argument("scan without a stamp");
  ram_slam::LaserScan scan;
  scan.stamp_ns = toNanoseconds(message.header.stamp);
  scan.angle_min_rad = message.angle_min;
  scan.angle_increment_rad = message.angle_increment;
  scan.time_increment_s = isPlausibleSweep(sweep_s(message)) ? message.time_increment : 0.0;
  scan.ranges_m = message.ranges;
  const bool has_limit = hasRangeLimit(message);
  scan.range_max_m = has_limit ? message.range_max : ram_slam::LaserScan::kUnlimitedRangeM;
  const bool is_tiny = message.range_min >= 0.0F && message.range_min < kLeastRangeM;
  scan.range_min_m = is_tiny ? kLeastRangeM : message.range_min;
  // Several drivers (LMS1xx, Stage, Gazebo) put the limit where nothing came back.
  if (has_limit) ram_slam::markNoReturns(kLimitShare * message.range_max, scan.ranges_m);
  scan.validate();
  return scan;
}

double toAddedMirrorTurn_s(const ram_slam_msgs::LidarCalibration& message) {
  if (!(std::abs(message.turn_time) <= 1.0)) {
    throw std::invalid_argument("no lidar is off by a turn_time of " +
                                std::to_string(message.turn_time) + " s");
  }
  return message.turn_time;
}

ram_slam_msgs::LidarCalibration toLidarMessage(const ram_slam::LidarCalibration& calibration) {
  ram_slam_msgs::LidarCalibration message;
  message.turn_time = calibration.addedMirrorTurn_s();
  message.turn_time_deviation = calibration.deviation_s();
  return message;
}

sensor_msgs::LaserScan toScanMessage(const ram_slam::LaserScan& scan) {
  sensor_msgs::LaserScan message;
  message.header.stamp = toTime(scan.stamp_ns);
  message.angle_min = static_cast<float>(scan.angle_min_rad);
  const std::size_t count = scan.ranges_m.size();
  if (count > 0) message.angle_max = static_cast<float>(scan.bearing_rad(count - 1));
  message.angle_increment = static_cast<float>(scan.angle_increment_rad);
  message.time_increment = static_cast<float>(scan.time_increment_s);
  message.range_min = scan.range_min_m;
  message.range_max = scan.range_max_m;
  message.ranges = scan.ranges_m;
  return message;
}

ram_slam::Feature toFeature(const ram_slam_msgs::Feature& message) {
  ram_slam::Feature feature;
  feature.type = message.type;
  if (message.classifier.size() <= ram_slam::WorldLandmark::kMaxClassifierLength)
    feature.classifier = message.classifier;
  const ram_slam::PoseWithCovariance2 pose = toPoseWithCovariance2(message.pose);
  feature.position_m = pose.pose.translation();
  feature.covariance_m2 = pose.covariance.topLeftCorner<2, 2>();
  feature.orientation_rad = pose.pose.yaw_rad;
  feature.orientation_variance_rad2 = pose.covariance(2, 2);
  const Eigen::Matrix2d& c = feature.covariance_m2;
  if (std::abs(c(0, 1) - c(1, 0)) > kSymmetryTolerance * c.trace() || !(c(0, 0) > 0.0) ||
      !(c.determinant() > 0.0)) {
    throw std::invalid_argument("feature covariance is not symmetric and positive definite");
  }
  if (!(feature.orientation_variance_rad2 > 0.0))
    throw std::invalid_argument("variance of a feature's orientation is not positive");
  return feature;
}

ram_slam_msgs::Feature toFeatureMessage(const ram_slam::Feature& feature,
                                        const std_msgs::Header& header) {
  ram_slam::PoseWithCovariance2 pose;
  pose.pose = {feature.position_m.x(), feature.position_m.y(), feature.orientation_rad};
  pose.covariance.topLeftCorner<2, 2>() = feature.covariance_m2;
  pose.covariance(2, 2) = feature.orientation_variance_rad2;
  ram_slam_msgs::Feature message;
  message.header = header;
  message.type = feature.type;
  message.classifier = feature.classifier;
  message.pose = toPoseWithCovarianceMessage(pose);
  return message;
}

CheckedFeatures toFeatureList(const ram_slam_msgs::FeatureList& message,
                              const std::string& frame_id) {
  if (message.header.frame_id != frame_id) {
    throw std::invalid_argument("they are in '" + message.header.frame_id + "' instead of '" +
                                frame_id + "'");
  }
  if (message.header.stamp.isZero()) throw std::invalid_argument("feature list without a stamp");
  CheckedFeatures checked;
  checked.list.stamp_ns = toNanoseconds(message.header.stamp);
  const std::size_t taken = std::min(message.features.size(), kMaxFeatures);
  checked.rejected_count = static_cast<int>(message.features.size() - taken);
  for (std::size_t i = 0; i < taken; ++i) {
    try {
      ram_slam::Feature feature = toFeature(message.features[i]);
      if (!(feature.position_m.norm() <= kFarthestRangeM) ||
          !(feature.covariance_m2.trace() <= kFarthestRangeM * kFarthestRangeM))
        throw std::invalid_argument("a feature is farther off or less certain than 1000 m");
      feature.delay_ns = delayOf(message.features[i].header.stamp, checked.list.stamp_ns);
      checked.list.features.push_back(std::move(feature));
    } catch (const std::invalid_argument&) {
      ++checked.rejected_count;
    }
  }
  return checked;
}

ram_slam_msgs::FeatureList toFeatureListMessage(const ram_slam::FeatureList& list,
                                                const std::string& frame_id) {
  ram_slam_msgs::FeatureList message;
  message.header.stamp = toTime(list.stamp_ns);
  message.header.frame_id = frame_id;
  for (const ram_slam::Feature& feature : list.features) {
    message.features.push_back(toFeatureMessage(feature, message.header));
    message.features.back().header.stamp = toTime(list.stamp_ns + feature.delay_ns);
  }
  return message;
}

ram_slam::Tracking toTracking(const ram_slam_msgs::Tracking& message,
                              const std::string& map_frame) {
  if (message.header.frame_id != map_frame) {
    throw std::invalid_argument("its frame is '" + message.header.frame_id + "', not '" +
                                map_frame + "'");
  }
  return {static_cast<bool>(message.lost), toNanoseconds(message.header.stamp),
          toNanoseconds(message.certain_until), toPose2(message.pose)};
}

}  // namespace ram_slam_ros
