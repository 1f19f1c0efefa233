// SPDX-License-Identifier: BSD-3-Clause
// What comes over the wire: conversions of messages whose fields have any values, encoded messages
// of recordings, and what detectors and matchers make of them.
#include <array>

#include <fuzz_targets.hpp>
#include <ram_slam/geometry/trajectory.hpp>
#include <ram_slam/ros/conversions.hpp>
#include <ram_slam/ros/mounting.hpp>
#include <ram_slam/ros/occupancy_conversions.hpp>

#include "../../ros/message_decoder.hpp"
#include "../recorded_bytes.hpp"
#include "fuzz_target.hpp"

namespace ramscout_bringup_ros {
namespace {

using namespace ramscout_feature_detector;

constexpr std::size_t kMostElements = 64;

ros::Time takeTime(ByteReader& in) {
  const auto sec = in.take<std::uint32_t>();
  return {sec, in.take<std::uint32_t>() % 1'000'000'000U};
}

void take(ByteReader& in, geometry_msgs::Pose& pose) {
  for (double* value : {&pose.position.x, &pose.position.y, &pose.position.z})
    *value = in.take<double>();
  const double half_yaw_rad = 1e-3 * in.take<std::int16_t>();
  pose.orientation.w = std::cos(half_yaw_rad);
  pose.orientation.z = std::sin(half_yaw_rad);
  pose.orientation.x = 1e-4 * in.take<std::int8_t>();
}

void take(ByteReader& in, geometry_msgs::PoseWithCovariance& pose) {
  take(in, pose.pose);
  for (double& value : pose.covariance) value = in.take<float>();
}

/// What is accepted keeps the rules of the core, and what the core gives can be sent.
void readScan(const std::string& bytes) {
  ByteReader in(bytes);
  sensor_msgs::LaserScan scan;
  scan.header.stamp = takeTime(in);
  for (float* value : {&scan.angle_min, &scan.angle_increment, &scan.time_increment,
                       &scan.range_min, &scan.range_max})
    *value = in.take<float>();
  while (!in.isAtEnd()) scan.ranges.push_back(in.take<float>());
  scan.angle_max = scan.angle_min + static_cast<float>(scan.ranges.size()) * scan.angle_increment;
  const ram_slam::LaserScan read = ram_slam_ros::toLaserScan(scan);
  read.validate();
  for (std::size_t i = 0; i < read.ranges_m.size(); ++i) {
    if (read.at(i) == ram_slam::Return::kHit && !read.end_m(i).allFinite())
      throw std::logic_error("a hit that is nowhere");
  }
}

void readOdometry(const std::string& bytes) {
  ByteReader in(bytes);
  nav_msgs::Odometry odometry;
  odometry.header.frame_id = in.text();
  odometry.child_frame_id = in.text();
  take(in, odometry.pose);
  const ram_slam::PoseWithCovariance2 pose = ram_slam_ros::toPoseWithCovariance2(odometry.pose);
  if (!std::isfinite(pose.pose.x_m + pose.pose.y_m + pose.pose.yaw_rad) ||
      !pose.covariance.allFinite())
    throw std::logic_error("odometry that is not finite is accepted");
  ram_slam_ros::requireFrames(odometry, "odom", "base");
}

void readTransform(const std::string& bytes) {
  ByteReader in(bytes);
  geometry_msgs::Transform transform;
  geometry_msgs::Vector3& position = transform.translation;
  geometry_msgs::Quaternion& rotation = transform.rotation;
  for (double* value :
       {&position.x, &position.y, &position.z, &rotation.x, &rotation.y, &rotation.z, &rotation.w})
    *value = in.take<double>();
  ram_slam_ros::toMounting(transform);
  ram_slam_ros::toPose2(transform);
}

void readFeatures(const std::string& bytes) {
  ByteReader in(bytes);
  ram_slam_msgs::FeatureList list;
  list.header.stamp = takeTime(in);
  list.header.frame_id = "base_link";
  while (!in.isAtEnd() && list.features.size() < kMostElements) {
    ram_slam_msgs::Feature& feature = list.features.emplace_back();
    feature.header = list.header;
    feature.header.stamp.nsec += in.take<std::uint8_t>();
    feature.type = in.text();
    feature.classifier = in.text();
    take(in, feature.pose);
  }
  requireFinite(ram_slam_ros::toFeatureList(list, "base_link").list);
}

void readPath(const std::string& bytes) {
  ByteReader in(bytes);
  nav_msgs::Path path;
  while (!in.isAtEnd() && path.poses.size() < kMostElements) {
    geometry_msgs::PoseStamped& pose = path.poses.emplace_back();
    pose.header.stamp = takeTime(in);
    take(in, pose.pose);
  }
  const ram_slam::Trajectory trajectory = ram_slam_ros::toTrajectory(path);
  validate(trajectory);
  if (!trajectory.empty())
    poseAt(trajectory, trajectory.front().stamp_ns / 2 + trajectory.back().stamp_ns / 2);
}

void readGrid(const std::string& bytes) {
  ByteReader in(bytes);
  nav_msgs::OccupancyGrid grid;
  grid.info.width = in.take<std::uint32_t>();
  grid.info.height = in.take<std::uint32_t>();
  grid.info.resolution = in.take<float>();
  take(in, grid.info.origin);
  while (!in.isAtEnd()) grid.data.push_back(in.take<std::int8_t>());
  const ram_slam::OccupancyGrid read = ram_slam_ros::toOccupancyGrid(grid);
  if (read.cells.size() !=
      static_cast<std::size_t>(read.width) * static_cast<std::size_t>(read.height))
    throw std::logic_error("a grid with more or fewer cells than its sides state");
}

/// The first byte chooses type and encoding.
void readEncoded(const std::string& bytes) {
  static const std::array<const char*, 4> kTypes = {"sensor_msgs/LaserScan", "nav_msgs/Odometry",
                                                    "tf2_msgs/TFMessage",
                                                    "sensor_msgs/MultiEchoLaserScan"};
  const auto first = static_cast<std::uint8_t>(bytes.empty() ? 0 : bytes[0]);
  const std::string message = bytes.empty() ? "" : bytes.substr(1);
  decode(kTypes[first % 4U], first / 4U % 2U == 0 ? "cdr" : "ros1",
         reinterpret_cast<const std::uint8_t*>(message.data()), message.size());
}

template <typename Detector, typename Parameters>
FuzzTarget detectorTarget(const std::string& name,
                          const Parameters& parameters,
                          std::size_t most_beams) {
  const auto detector = std::make_shared<const Detector>(parameters);
  const auto read = [detector, most_beams](const std::string& bytes) {
    tryScan(*detector, scanOfBytes(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                   bytes.size(), most_beams));
  };
  return {name, {std::string(1, '\0') + std::string(most_beams, '\x7c')}, read, false};
}

/// Small, so that many are tried.
FeatureDetectorParameters smallImage() {
  FeatureDetectorParameters parameters;
  parameters.ppm = 50.0;
  parameters.kernel_radius = 15;
  parameters.scale_levels = 1;
  parameters.max_features = 1;
  return parameters;
}

std::string scanSeed() {
  std::string bytes;
  put(bytes, std::uint64_t{5});
  for (const float value : {-1.0F, 0.5F, 0.001F, 0.1F, 8.0F, 1.0F, 2.0F, 8.0F, 3.0F})
    put(bytes, value);
  return bytes;
}

std::string transformSeed() {
  std::string bytes;
  for (const double value : {0.2, 0.0, 0.3, 0.0, 0.0, 0.6, 0.8}) put(bytes, value);
  return bytes;
}

std::string pathSeed() {
  std::string bytes;
  for (std::uint64_t sec = 1; sec <= 3; ++sec) {
    put(bytes, sec);
    for (const double value : {0.5, -1.0, 0.0}) put(bytes, value);
    bytes += std::string(3, '\0');
  }
  return bytes;
}

}  // namespace

std::vector<FuzzTarget> messageTargets() {
  const std::string any(200, '\x3f');  // doubles of about 0.0005
  return {
      {"scan", {scanSeed()}, readScan, false},
      {"odometry", {std::string("\4odom\4base") + any}, readOdometry, false},
      {"transform", {transformSeed()}, readTransform, false},
      {"features", {any}, readFeatures, false},
      {"path", {pathSeed()}, readPath, false},
      {"grid",
       {std::string("\2\0\0\0\3\0\0\0", 8) + any.substr(0, 31) + std::string(6, '\0')},
       readGrid,
       false},
      {"encoded_message",
       {'\0' + scanBytes(5), '\1' + odometryBytes(), '\2' + transformBytes()},
       readEncoded,
       false},
      {"classifier",
       {std::string(65, '\0'), '\1' + std::string(132, 'b')},
       [](const std::string& bytes) {
         tryClassifier(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
       },
       false},
      detectorTarget<FeatureDetector>("corner_scan", smallImage(), 24),
      detectorTarget<EdgeDetector>("edge_scan", EdgeDetectorParameters(), 32),
  };
}

}  // namespace ramscout_bringup_ros
