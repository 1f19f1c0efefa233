// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/picture.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "room_results.hpp"

namespace ramscout_bringup {
namespace {

Results room() {
  return roomResults(1);
}

cv::Mat decode(const std::string& png) {
  return cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

/// Pixel of a point of the room: 8 pixels per cell, 1 m of margin, y up.
cv::Vec3b at(const cv::Mat& image, double x_m, double y_m) {
  return image.at<cv::Vec3b>(static_cast<int>((6.0 + 1.0 - y_m) * 160.0),
                             static_cast<int>((x_m + 1.0) * 160.0));
}

TEST(DrawPicture, HasWallsFloorPathAndLandmarksWhereTheyAre) {
  Results results = room();
  MapLandmark landmark;
  landmark.position_m = {2.0, 5.0};
  landmark.covariance_m2 << 0.25, 0.0, 0.0, 0.01;
  results.landmarks.push_back(landmark);
  const cv::Mat image = decode(drawPicture(results));
  ASSERT_FALSE(image.empty());
  EXPECT_EQ(at(image, 5.0, 1.0), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(at(image, 5.0, 0.025), cv::Vec3b(30, 30, 30));
  EXPECT_EQ(at(image, 5.0, -0.5), cv::Vec3b(222, 222, 222));
  EXPECT_GT(at(image, 5.5, 3.0)[0], at(image, 5.5, 3.0)[2] + 100);  // blue
  EXPECT_GT(at(image, 2.0, 5.0)[2], at(image, 2.0, 5.0)[0] + 100);  // red
  EXPECT_GT(at(image, 2.5, 5.0)[2], at(image, 2.5, 5.0)[0] + 50);  // the end of the 1-sigma ellipse
  EXPECT_EQ(at(image, 2.0, 5.5), cv::Vec3b(255, 255, 255));
}

TEST(DrawPicture, TruthOfAnotherFrameIsDrawnOntoThePath) {
  Results results = room();
  const cv::Mat without = decode(drawPicture(results));
  const ram_slam::Pose2 truth_from_map{100.0, -50.0, 2.0};
  for (const auto& pose : results.trajectory) {
    results.ground_truth.push_back({pose.stamp_ns, truth_from_map * pose.pose});
  }
  const cv::Mat with = decode(drawPicture(results));
  EXPECT_EQ(with.size(), without.size());
  EXPECT_NE(at(with, 5.5, 3.0 + 2.0 / 160.0), at(without, 5.5, 3.0 + 2.0 / 160.0));
}

TEST(DrawPicture, OfNothingIsStillAPicture) {
  EXPECT_FALSE(decode(drawPicture(Results{})).empty());
}

TEST(DrawPicture, IsTheSameToTheByteEachTime) {
  EXPECT_EQ(drawPicture(room()), drawPicture(room()));
  EXPECT_EQ(drawPicture(room()).substr(1, 3), "PNG");
}

TEST(DrawPicture, OfALargeMapStaysWithinTheLongestEdge) {
  Results results;
  results.trajectory = {{kSecond, {0.0, 0.0, 0.0}}, {2 * kSecond, {20000.0, 100.0, 0.0}}};
  const cv::Mat image = decode(drawPicture(results));
  ASSERT_FALSE(image.empty());
  EXPECT_LE(image.cols, static_cast<int>(PictureLayout{}.max_edge_px) + 1);
}

TEST(DrawPicture, OfATurnedMapHasItsWallsWhereTheMapFrameHasThem) {
  Results results = room();
  results.trajectory.clear();
  results.map.map_from_grid = {6.0, 0.0, M_PI_2};  // the lower wall becomes the right one
  const cv::Mat image = decode(drawPicture(results));
  const auto pixel = [&](double x_m, double y_m) {  // 10 m high, with a margin of 1 m
    return image.at<cv::Vec3b>(static_cast<int>((10.0 + 1.0 - y_m) * 160.0),
                               static_cast<int>((x_m + 1.0) * 160.0));
  };
  EXPECT_EQ(pixel(5.975, 5.0), cv::Vec3b(30, 30, 30));
  EXPECT_EQ(pixel(3.0, 5.0), cv::Vec3b(255, 255, 255));
}

TEST(DrawMapImage, ShowsTheKnownPartOfTheMapAndWhereItLies) {
  ram_slam::OccupancyGrid map;
  map.width = 100;
  map.height = 50;
  map.resolution_m = 0.1;
  map.map_from_grid = {-2.0, 3.0, 0.0};
  map.cells.assign(100 * 50, ram_slam::kUnknownCell);
  for (int x = 20; x < 30; ++x) map.cells[map.index(x, 10)] = ram_slam::kFreeCell;
  map.cells[map.index(29, 12)] = ram_slam::kOccupiedCell;
  const MapImage drawn = drawMapImage(map, 1'000'000, 4000);
  const cv::Mat image = decode(drawn.png);
  ASSERT_EQ(image.size(), cv::Size(10, 3));
  EXPECT_EQ(image.at<cv::Vec3b>(2, 0), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(image.at<cv::Vec3b>(0, 9), cv::Vec3b(30, 30, 30));
  EXPECT_EQ(image.at<cv::Vec3b>(1, 5), cv::Vec3b(222, 222, 222));
  EXPECT_NEAR(drawn.map_from_image.x_m, 0.0, 1e-12);
  EXPECT_NEAR(drawn.map_from_image.y_m, 4.0, 1e-12);
  EXPECT_DOUBLE_EQ(drawn.resolution_m, 0.1);
}

TEST(DrawMapImage, JoinsCellsWithoutLosingAWall) {
  ram_slam::OccupancyGrid map;
  map.width = 1000;
  map.height = 10;
  map.resolution_m = 0.05;
  map.cells.assign(10'000, ram_slam::kFreeCell);
  map.cells[map.index(501, 4)] = ram_slam::kOccupiedCell;
  const MapImage drawn = drawMapImage(map, 1'000'000, 250);
  const cv::Mat image = decode(drawn.png);
  EXPECT_EQ(image.size(), cv::Size(250, 3));
  EXPECT_DOUBLE_EQ(drawn.resolution_m, 0.2);
  EXPECT_EQ(image.at<cv::Vec3b>(1, 125), cv::Vec3b(30, 30, 30));
}

TEST(DrawMapImage, OfAnUnknownMapIsEmpty) {
  ram_slam::OccupancyGrid map;
  map.width = map.height = 2;
  map.cells.assign(4, ram_slam::kUnknownCell);
  EXPECT_TRUE(drawMapImage(map, 1000, 1000).png.empty());
  EXPECT_TRUE(drawMapImage({}, 1000, 1000).png.empty());
}

}  // namespace
}  // namespace ramscout_bringup
