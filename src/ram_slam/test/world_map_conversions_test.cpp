// SPDX-License-Identifier: BSD-3-Clause
#include "../ros/world_map_conversions.hpp"

#include <cstring>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <sensor_msgs/PointField.h>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "world_map/example_world.hpp"

namespace ram_slam_ros {
namespace {

using sensor_msgs::PointField;
using testing::HasSubstr;
using testing::ThrowsMessage;

ram_slam::ColoredCloud exampleCloud() {
  return ram_slam::cloudAt(ram_slam::poseAt(1.0, 2.0, 0.5), "camera");
}

void expectSame(const ram_slam::SpatialPose& a, const ram_slam::SpatialPose& b) {
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.orientation.coeffs(), b.orientation.coeffs());
  EXPECT_EQ(a.covariance, b.covariance);
}

/// One point with the given fields, each of four bytes, filled with 1.0F.
ram_slam_msgs::ColoredCloud pointWith(
    const std::vector<std::pair<std::string, std::uint8_t>>& fields) {
  ram_slam_msgs::ColoredCloud message;
  message.pose.pose.orientation.w = 1.0;
  sensor_msgs::PointCloud2& cloud = message.cloud;
  for (const auto& [name, datatype] : fields) {
    PointField field;
    field.name = name;
    field.offset = cloud.point_step;
    field.datatype = datatype;
    field.count = 1;
    cloud.fields.push_back(field);
    cloud.point_step += 4;
  }
  cloud.width = cloud.height = 1;
  cloud.row_step = cloud.point_step;
  cloud.data.resize(cloud.row_step);
  const float one = 1.0F;
  for (std::size_t at = 0; at < cloud.data.size(); at += 4) std::memcpy(&cloud.data[at], &one, 4);
  return message;
}

const std::vector<std::pair<std::string, std::uint8_t>> kFields{{"x", PointField::FLOAT32},
                                                                {"y", PointField::FLOAT32},
                                                                {"z", PointField::FLOAT32},
                                                                {"rgb", PointField::UINT32}};

TEST(WorldMapConversions, LandmarksReadBackAsTheyWere) {
  const ram_slam::LandmarkLayer layer = ram_slam::exampleLandmarks();
  const ram_slam::LandmarkLayer back = toLandmarkLayer(toLandmarkMapMessage(layer, "map"));
  EXPECT_EQ(back.stamp_ns, layer.stamp_ns);
  ASSERT_EQ(back.landmarks.size(), layer.landmarks.size());
  for (std::size_t i = 0; i < back.landmarks.size(); ++i) {
    EXPECT_EQ(back.landmarks[i].id, layer.landmarks[i].id);
    EXPECT_EQ(back.landmarks[i].stamp_ns, layer.landmarks[i].stamp_ns);
    EXPECT_EQ(back.landmarks[i].type, layer.landmarks[i].type);
    EXPECT_EQ(back.landmarks[i].classifier, layer.landmarks[i].classifier);
    EXPECT_EQ(back.landmarks[i].existence_log_odds, layer.landmarks[i].existence_log_odds);
    expectSame(back.landmarks[i].pose, layer.landmarks[i].pose);
  }
  ASSERT_EQ(back.cross_covariances.size(), layer.cross_covariances.size());
  for (std::size_t i = 0; i < back.cross_covariances.size(); ++i) {
    EXPECT_EQ(back.cross_covariances[i].first_id, layer.cross_covariances[i].first_id);
    EXPECT_EQ(back.cross_covariances[i].second_id, layer.cross_covariances[i].second_id);
    EXPECT_EQ(back.cross_covariances[i].covariance_m2, layer.cross_covariances[i].covariance_m2);
  }
}

TEST(WorldMapConversions, ABlockIsWrittenRowByRow) {
  ram_slam::LandmarkLayer layer;
  Eigen::Matrix3d block;
  block << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  layer.cross_covariances = {{1, 2, block}};
  EXPECT_THAT(toLandmarkMapMessage(layer, "map").covariances[0].covariance,
              testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(WorldMapConversions, AGridKeepsItsFrameItsPlaceAndItsCells) {
  const ram_slam::LocalOccupancy occupancy =
      ram_slam::occupancyAt(ram_slam::poseAt(3.0, -1.0, 0.25), 7'000'000'000, "room");
  ram_slam_msgs::LocalOccupancy message;
  message.header.frame_id = "map";
  message.header.stamp = toTime(occupancy.stamp_ns);
  message.grid = toOccupancyGridMessage(occupancy.grid, "room", occupancy.stamp_ns);
  message.pose.pose.position.x = 3.0;
  message.pose.pose.orientation.w = 1.0;
  message.pose.covariance[5] = 0.125;
  const ram_slam::LocalOccupancy back = toLocalOccupancy(message);
  EXPECT_EQ(back.stamp_ns, 7'000'000'000);
  EXPECT_EQ(back.frame, "room");
  EXPECT_EQ(back.grid.cells, occupancy.grid.cells);
  EXPECT_EQ(back.grid.resolution_m, 0.5);
  EXPECT_EQ(back.map_from_frame.position_m.x(), 3.0);
  EXPECT_EQ(back.map_from_frame.covariance(0, 5), 0.125);
}

TEST(WorldMapConversions, ACloudReadsBackToTheBit) {
  const ram_slam::ColoredCloud cloud = exampleCloud();
  const ram_slam::ColoredCloud back = toColoredCloud(toColoredCloudMessage(cloud, "map"));
  EXPECT_EQ(back.stamp_ns, cloud.stamp_ns);
  EXPECT_EQ(back.frame, "camera");
  expectSame(back.map_from_frame, cloud.map_from_frame);
  ASSERT_EQ(back.points.size(), cloud.points.size());
  for (std::size_t i = 0; i < back.points.size(); ++i) {
    EXPECT_EQ(back.points[i].x_m, cloud.points[i].x_m);
    EXPECT_EQ(back.points[i].y_m, cloud.points[i].y_m);
    EXPECT_EQ(back.points[i].z_m, cloud.points[i].z_m);
    EXPECT_EQ(back.points[i].rgb, cloud.points[i].rgb);
  }
}

TEST(WorldMapConversions, TheOrderOfTheFieldsOfACloudDoesNotMatter) {
  auto message = pointWith({{"rgb", PointField::FLOAT32},
                            {"intensity", PointField::FLOAT32},
                            {"z", PointField::FLOAT32},
                            {"y", PointField::FLOAT32},
                            {"x", PointField::FLOAT32}});
  const float values[] = {0.0F, 9.0F, 3.0F, 2.0F, 1.0F};
  std::memcpy(message.cloud.data.data(), values, sizeof values);
  const std::uint32_t rgb = 0x00abcdefU;
  std::memcpy(message.cloud.data.data(), &rgb, sizeof rgb);
  const ram_slam::ColoredPoint point = toColoredCloud(message).points.at(0);
  EXPECT_EQ(point.x_m, 1.0F);
  EXPECT_EQ(point.y_m, 2.0F);
  EXPECT_EQ(point.z_m, 3.0F);
  EXPECT_EQ(point.rgb, 0x00abcdefU);
}

TEST(WorldMapConversions, PointsThatAreNotFiniteAreLeftOut) {
  ram_slam::ColoredCloud cloud = exampleCloud();
  cloud.points.push_back({std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F, 0U});
  cloud.points.push_back({0.0F, 0.0F, std::numeric_limits<float>::infinity(), 0U});
  cloud.points.push_back({7.0F, 0.0F, 0.0F, 0U});
  const auto back = toColoredCloud(toColoredCloudMessage(cloud, "map")).points;
  ASSERT_EQ(back.size(), 3u);
  EXPECT_EQ(back[2].x_m, 7.0F);
}

TEST(WorldMapConversions, RowsOfACloudMayBePadded) {
  auto message = pointWith(kFields);
  message.cloud.height = 2;
  message.cloud.row_step = message.cloud.point_step + 8;
  const std::vector<std::uint8_t> point = message.cloud.data;
  message.cloud.data.assign(2 * message.cloud.row_step, 0xff);  // padding that is no number
  for (const std::size_t row : {0, 1})
    std::copy(
        point.begin(), point.end(),
        message.cloud.data.begin() + static_cast<std::ptrdiff_t>(row * message.cloud.row_step));
  const auto points = toColoredCloud(message).points;
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].z_m, 1.0F);
}

TEST(WorldMapConversions, CloudsWithoutAFieldOrOfAnotherTypeAreRefusedByItsName) {
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    auto fields = kFields;
    fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_THAT([&] { toColoredCloud(pointWith(fields)); },
                ThrowsMessage<std::invalid_argument>(
                    HasSubstr("without a field '" + kFields[i].first + "' of 4 bytes")));
    fields = kFields;
    fields[i].second = PointField::FLOAT64;
    EXPECT_THROW(toColoredCloud(pointWith(fields)), std::invalid_argument) << kFields[i].first;
  }
  auto fields = kFields;
  fields[0].second = PointField::UINT32;  // an integer is a colour, but no coordinate
  EXPECT_THROW(toColoredCloud(pointWith(fields)), std::invalid_argument);
}

TEST(WorldMapConversions, CloudsWhoseSizesContradictEachOtherAreRefused) {
  const auto refused = [](const auto& change) {
    auto message = pointWith(kFields);
    change(message.cloud);
    EXPECT_THROW(toColoredCloud(message), std::invalid_argument);
  };
  EXPECT_EQ(toColoredCloud(pointWith(kFields)).points.size(), 1u);
  refused([](auto& cloud) { cloud.data.pop_back(); });
  refused([](auto& cloud) { cloud.width = 2; });
  refused([](auto& cloud) { cloud.height = 2; });
  refused([](auto& cloud) { cloud.row_step = 4; });
  refused([](auto& cloud) { cloud.is_bigendian = 1; });
  refused([](auto& cloud) { cloud.fields[3].offset = cloud.point_step - 3; });
  refused([](auto& cloud) { cloud.fields[0].offset = 0xfffffffeU; });
  refused([](auto& cloud) { cloud.width = 0xffffffffU; });
}

TEST(WorldMapConversions, TheAnswerToARegionHasAllThatLiesInIt) {
  const ram_slam::MapRegion region = ram_slam::exampleWorld().region({-1.0, -1.0, 3.0, 3.0});
  const auto response = toRegionResponse(region, "map");
  EXPECT_TRUE(response.success);
  EXPECT_EQ(response.grid.header.frame_id, "map");
  EXPECT_EQ(toOccupancyGrid(response.grid).cells, region.grid.cells);
  EXPECT_EQ(response.landmarks.landmarks.size(), 2u);
  ASSERT_EQ(response.clouds.size(), region.clouds.size());
  EXPECT_EQ(response.clouds[0].cloud.width, region.clouds[0].points.size());
}

}  // namespace
}  // namespace ram_slam_ros
