// SPDX-License-Identifier: BSD-3-Clause
#include "world_map_conversions.hpp"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/PointField.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

namespace ram_slam_ros {
namespace {

ram_slam::SpatialPose toSpatialPose(const geometry_msgs::PoseWithCovariance& message) {
  ram_slam::SpatialPose pose;
  const geometry_msgs::Point& position = message.pose.position;
  const geometry_msgs::Quaternion& orientation = message.pose.orientation;
  pose.position_m = {position.x, position.y, position.z};
  pose.orientation = Eigen::Quaterniond(orientation.w, orientation.x, orientation.y, orientation.z);
  for (int i = 0; i < 36; ++i) pose.covariance(i / 6, i % 6) = message.covariance[i];
  return pose;
}

geometry_msgs::PoseWithCovariance toMessage(const ram_slam::SpatialPose& pose) {
  geometry_msgs::PoseWithCovariance message;
  message.pose.position.x = pose.position_m.x();
  message.pose.position.y = pose.position_m.y();
  message.pose.position.z = pose.position_m.z();
  message.pose.orientation.w = pose.orientation.w();
  message.pose.orientation.x = pose.orientation.x();
  message.pose.orientation.y = pose.orientation.y();
  message.pose.orientation.z = pose.orientation.z();
  for (int i = 0; i < 36; ++i) message.covariance[i] = pose.covariance(i / 6, i % 6);
  return message;
}

/// Where a field of four bytes starts within a point.
std::uint32_t offsetOf(const sensor_msgs::PointCloud2& cloud,
                       const std::string& name,
                       bool may_be_integer) {
  for (const sensor_msgs::PointField& field : cloud.fields) {
    if (field.name != name) continue;
    const bool typed = field.datatype == sensor_msgs::PointField::FLOAT32 ||
                       (may_be_integer && field.datatype == sensor_msgs::PointField::UINT32);
    if (!typed || field.offset > cloud.point_step ||
        cloud.point_step - field.offset < sizeof(float))
      break;
    return field.offset;
  }
  throw std::invalid_argument("cloud without a field '" + name + "' of 4 bytes");
}

void checkLayout(const sensor_msgs::PointCloud2& cloud) {
  if (cloud.is_bigendian != 0) throw std::invalid_argument("cloud is big-endian");
  const std::uint64_t row_size = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.row_step < row_size ||
      std::uint64_t{cloud.height} * cloud.row_step != cloud.data.size()) {
    throw std::invalid_argument("cloud whose row_step or size of data does not fit its fields");
  }
}

}  // namespace

ram_slam::LocalOccupancy toLocalOccupancy(const ram_slam_msgs::LocalOccupancy& message) {
  ram_slam::LocalOccupancy occupancy;
  occupancy.stamp_ns = toNanoseconds(message.header.stamp);
  occupancy.frame = message.grid.header.frame_id;
  occupancy.map_from_frame = toSpatialPose(message.pose);
  occupancy.grid = toOccupancyGrid(message.grid);
  return occupancy;
}

ram_slam::LandmarkLayer toLandmarkLayer(const ram_slam_msgs::LandmarkMap& message) {
  ram_slam::LandmarkLayer layer;
  layer.stamp_ns = toNanoseconds(message.header.stamp);
  for (const ram_slam_msgs::Landmark& from : message.landmarks) {
    ram_slam::WorldLandmark landmark;
    landmark.id = from.id;
    landmark.stamp_ns = toNanoseconds(from.feature.header.stamp);
    landmark.type = from.feature.type;
    landmark.classifier = from.feature.classifier;
    landmark.pose = toSpatialPose(from.feature.pose);
    landmark.existence_log_odds = from.existence_log_odds;
    layer.landmarks.push_back(std::move(landmark));
  }
  for (const ram_slam_msgs::CovarianceBlock& from : message.covariances) {
    ram_slam::LandmarkCrossCovariance block{from.first_id, from.second_id, Eigen::Matrix3d::Zero()};
    for (int i = 0; i < 9; ++i) block.covariance_m2(i / 3, i % 3) = from.covariance[i];
    layer.cross_covariances.push_back(block);
  }
  return layer;
}

ram_slam_msgs::LandmarkMap toLandmarkMapMessage(const ram_slam::LandmarkLayer& landmarks,
                                                const std::string& frame_id) {
  ram_slam_msgs::LandmarkMap message;
  message.header.stamp = toTime(landmarks.stamp_ns);
  message.header.frame_id = frame_id;
  for (const ram_slam::WorldLandmark& from : landmarks.landmarks) {
    ram_slam_msgs::Landmark landmark;
    landmark.id = from.id;
    landmark.feature.header.stamp = toTime(from.stamp_ns);
    landmark.feature.header.frame_id = frame_id;
    landmark.feature.type = from.type;
    landmark.feature.classifier = from.classifier;
    landmark.feature.pose = toMessage(from.pose);
    landmark.existence_log_odds = from.existence_log_odds;
    message.landmarks.push_back(std::move(landmark));
  }
  for (const ram_slam::LandmarkCrossCovariance& from : landmarks.cross_covariances) {
    ram_slam_msgs::CovarianceBlock block;
    block.first_id = from.first_id;
    block.second_id = from.second_id;
    for (int i = 0; i < 9; ++i) block.covariance[i] = from.covariance_m2(i / 3, i % 3);
    message.covariances.push_back(block);
  }
  return message;
}

ram_slam::ColoredCloud toColoredCloud(const ram_slam_msgs::ColoredCloud& message) {
  const sensor_msgs::PointCloud2& from = message.cloud;
  checkLayout(from);
  const std::uint32_t x = offsetOf(from, "x", false);
  const std::uint32_t y = offsetOf(from, "y", false);
  const std::uint32_t z = offsetOf(from, "z", false);
  const std::uint32_t rgb = offsetOf(from, "rgb", true);
  ram_slam::ColoredCloud cloud;
  cloud.stamp_ns = toNanoseconds(message.header.stamp);
  cloud.frame = from.header.frame_id;
  cloud.map_from_frame = toSpatialPose(message.pose);
  for (std::uint32_t row = 0; row < from.height; ++row) {
    for (std::uint32_t column = 0; column < from.width; ++column) {
      const std::uint8_t* data = from.data.data() + std::size_t{row} * from.row_step +
                                 std::size_t{column} * from.point_step;
      ram_slam::ColoredPoint point;
      std::memcpy(&point.x_m, data + x, sizeof point.x_m);
      std::memcpy(&point.y_m, data + y, sizeof point.y_m);
      std::memcpy(&point.z_m, data + z, sizeof point.z_m);
      std::memcpy(&point.rgb, data + rgb, sizeof point.rgb);
      if (std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m)) {
        cloud.points.push_back(point);
      }
    }
  }
  return cloud;
}

ram_slam_msgs::ColoredCloud toColoredCloudMessage(const ram_slam::ColoredCloud& cloud,
                                                  const std::string& frame_id) {
  ram_slam_msgs::ColoredCloud message;
  message.header.stamp = toTime(cloud.stamp_ns);
  message.header.frame_id = frame_id;
  message.pose = toMessage(cloud.map_from_frame);
  message.cloud.header.stamp = message.header.stamp;
  message.cloud.header.frame_id = cloud.frame;
  sensor_msgs::PointCloud2Modifier modifier(message.cloud);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(cloud.points.size());
  sensor_msgs::PointCloud2Iterator<float> position(message.cloud, "x");
  sensor_msgs::PointCloud2Iterator<float> rgb(message.cloud, "rgb");
  for (const ram_slam::ColoredPoint& point : cloud.points) {
    position[0] = point.x_m;
    position[1] = point.y_m;
    position[2] = point.z_m;
    std::memcpy(&*rgb, &point.rgb, sizeof point.rgb);
    ++position;
    ++rgb;
  }
  return message;
}

ram_slam_msgs::GetRegion::Response toRegionResponse(const ram_slam::MapRegion& region,
                                                    const std::string& frame_id) {
  ram_slam_msgs::GetRegion::Response response;
  response.success = true;
  response.grid = toOccupancyGridMessage(region.grid, frame_id, region.grid_stamp_ns);
  response.landmarks = toLandmarkMapMessage(region.landmarks, frame_id);
  for (const ram_slam::ColoredCloud& cloud : region.clouds) {
    response.clouds.push_back(toColoredCloudMessage(cloud, frame_id));
  }
  return response;
}

}  // namespace ram_slam_ros
