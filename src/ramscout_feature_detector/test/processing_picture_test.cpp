// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/processing_picture.hpp"

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

/// Two walls that meet at (3, 0) at a right angle, open towards the laser.
PolygonWorld corner() {
  PolygonWorld world;
  world.add({{-7.0, -10.0}, {3.0, 0.0}, {-7.0, 10.0}}, false);
  return world;
}

TEST(PictureOfProcessing, ShowsRasterResponseAndCorner) {
  ram_slam::Random random(7);
  const auto scan = corner().scan({}, 0.01, random);
  const Picture picture = pictureOfProcessing(FeatureDetector({}), scan);
  ASSERT_EQ(picture.columns, 1500);
  ASSERT_EQ(picture.rows, 500);
  const auto red = [&](int row, int column) { return picture.rgb[3 * (row * 1500 + column)]; };
  const int row = 250;          // y = 0
  const int column = 250 + 75;  // x = 3 m at 25 pixels per metre
  EXPECT_GT(red(row, column), 150);
  EXPECT_GT(red(row, 500 + column - 2), 50);
  EXPECT_EQ(red(row, 1000 + column), 255);
  EXPECT_EQ(red(row, 1000 + 250), 0);
}

TEST(PictureOfProcessing, PixelsOutsideOfThePictureAreNotSet) {
  Picture picture{2, 1, std::vector<std::uint8_t>(6, 0)};
  for (const auto& [row, column] :
       {std::make_pair(-1, 0), std::make_pair(1, 0), std::make_pair(0, -1), std::make_pair(0, 2)}) {
    picture.set(row, column, {1, 2, 3});
  }
  EXPECT_EQ(std::count(picture.rgb.begin(), picture.rgb.end(), 0), 6);
  picture.set(0, 1, {1, 2, 3});
  EXPECT_EQ(picture.rgb, (std::vector<std::uint8_t>{0, 0, 0, 1, 2, 3}));
}

TEST(PictureOfProcessing, SizeIsThatOfReachOrTheLimit) {
  ram_slam::Random random(7);
  const auto scan = corner().scan({}, 0.01, random);
  FeatureDetectorParameters parameters;
  parameters.picture.reach_m = 2.0;
  EXPECT_EQ(pictureOfProcessing(FeatureDetector(parameters), scan).rows, 100);  // 4 m at 25 px/m
  parameters.picture.max_pixels = 60;
  EXPECT_EQ(pictureOfProcessing(FeatureDetector(parameters), scan).columns, 180);
}

TEST(PictureOfProcessing, ScanWithoutHitsIsBlack) {
  ram_slam::Random random(7);
  const auto scan = PolygonWorld{}.scan({}, 0.0, random);
  const Picture picture = pictureOfProcessing(FeatureDetector({}), scan);
  EXPECT_EQ(*std::max_element(picture.rgb.begin(), picture.rgb.begin() + 1500), 0);
  EXPECT_EQ(picture.rgb[3 * 500], 90);  // the border of the second panel
  EXPECT_THROW(pictureOfProcessing(FeatureDetector({}), {}), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_feature_detector
