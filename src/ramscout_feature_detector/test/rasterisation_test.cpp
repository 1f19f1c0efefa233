// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/rasterisation.hpp"

#include <gtest/gtest.h>

#include "contours.hpp"

namespace ramscout_feature_detector {
namespace {

TEST(Extrapolate, ProlongsBothEndsAlongTheirTangents) {
  const Contour contour(wallsMeeting(0.5 * M_PI));
  const auto polyline_m = extrapolate(contour, 1.0, 0.2);
  ASSERT_EQ(polyline_m.size(), contour.size() + 2);
  const Eigen::Vector2d diagonal(std::sqrt(0.5), std::sqrt(0.5));
  EXPECT_NEAR((polyline_m.front() - (contour.front() - diagonal)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(
      (polyline_m.back() - (contour.back() - Eigen::Vector2d(diagonal.x(), -diagonal.y()))).norm(),
      0.0, 1e-9);
}

TEST(Extrapolate, ContoursOfAFewPointsHaveTangents) {
  const Contour contour({{3.0, -1.0}, {3.0, 0.0}, {3.0, 1.0}});
  const auto polyline_m = extrapolate(contour, 2.0, 0.2);
  EXPECT_NEAR((polyline_m.front() - Eigen::Vector2d(3.0, -3.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((polyline_m.back() - Eigen::Vector2d(3.0, 3.0)).norm(), 0.0, 1e-9);
}

/// A straight wall across the beams, 3 m ahead.
const std::vector<Eigen::Vector2d> kWallM = {{3.0, -5.0}, {3.0, 5.0}};

TEST(Rasterise, RidgeHasTheProfileOfTheRangeNoise) {
  FeatureDetectorParameters parameters;  // 100 pixels per metre, 2 cm: two pixels
  const ImagePatch patch = rasterise(kWallM, 280, -20, 0, parameters);
  for (int column = 14; column < 26; ++column) {
    const double off = (280 + column + 0.5 - 300.0) / 2.0;
    const double expected = std::abs(off) < 3.5 ? std::exp(-0.5 * off * off) : 0.0;
    EXPECT_NEAR(patch[20][column], expected, 1e-3) << column;
  }
}

TEST(Rasterise, CoarserLevelsShowTheSamePlaceMoreBlurred) {
  const FeatureDetectorParameters parameters;
  for (int level = 0; level < 3; ++level) {
    const int ridge = 300 >> level;
    const ImagePatch patch = rasterise(kWallM, ridge - 20, -20, level, parameters);
    const double sensor = 2.0 / (1 << level);
    const double variance = sensor * sensor + (1.0 - std::pow(0.25, level)) / 3.0;
    const double off = 2.5;
    EXPECT_NEAR(patch[20][22], std::exp(-0.5 * off * off / std::max(variance, 0.49)), 2e-3)
        << level;
  }
}

TEST(Rasterise, PatchesThatOverlapAgree) {
  const auto polyline_m = wallsMeeting(0.5 * M_PI);
  const ImagePatch a = rasterise(polyline_m, 280, -20, 0, {});
  const ImagePatch b = rasterise(polyline_m, 285, -13, 0, {});
  for (int row = 7; row < kPatchPixels; ++row)
    for (int column = 5; column < kPatchPixels; ++column)
      EXPECT_NEAR(a[row][column], b[row - 7][column - 5], 1e-3F);
}

TEST(Rasterise, NothingIsDrawnBeyondTheKernel) {
  const ImagePatch patch = rasterise(kWallM, 400, -20, 0, {});
  for (const auto& row : patch)
    for (const float pixel : row) EXPECT_EQ(pixel, 0.0F);
  FeatureDetectorParameters narrow;
  narrow.kernel_radius = 1;
  EXPECT_EQ(rasterise(kWallM, 280, -20, 0, narrow)[20][25], 0.0F);
  EXPECT_GT(rasterise(kWallM, 280, -20, 0, {})[20][25], 0.0F);
}

TEST(Rasterise, BearingNoiseWidensWallsAlongTheBeam) {
  const std::vector<Eigen::Vector2d> along_m = {{2.0, 0.0}, {4.0, 0.0}};
  FeatureDetectorParameters parameters;
  parameters.laser_angular_sigma = 0.01;  // 3 cm at 3 m, the middle of the wall
  const ImagePatch patch = rasterise(along_m, 280, -20, 0, parameters);
  EXPECT_NEAR(patch[23][20], std::exp(-0.5 * std::pow(3.5 / 3.0, 2)), 1e-3);
}

}  // namespace
}  // namespace ramscout_feature_detector
