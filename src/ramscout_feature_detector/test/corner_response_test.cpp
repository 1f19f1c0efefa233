// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/corner_response.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "contours.hpp"

namespace ramscout_feature_detector {
namespace {

/// The strongest peak near a place.
ResponsePeak strongest(const std::vector<ResponsePeak>& peaks) {
  return *std::max_element(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) {
    return a.min_eigenvalue < b.min_eigenvalue;
  });
}

TEST(CornerResponses, FlatImagesHaveNone) {
  ImagePatch image;
  for (auto& row : image) row.fill(0.7F);
  for (const auto& row : cornerResponses(image))
    for (const float response : row) EXPECT_EQ(response, 0.0F);
}

TEST(CornerResponses, StraightEdgesHaveNone) {
  ImagePatch image;
  for (auto& row : image)
    for (int i = 0; i < kPatchColumns; ++i) row[i] = i < 20 ? 0.0F : 1.0F;
  for (const auto& row : cornerResponses(image))
    for (const float response : row) EXPECT_NEAR(response, 0.0F, 1e-6F);
}

TEST(CornerResponses, TurningTheImageByAQuarterTurnsTheResponses) {
  ImagePatch image{};
  ImagePatch turned{};
  ram_slam::Random random(1);
  for (int row = 0; row < kPatchPixels; ++row) {
    for (int column = 0; column < kPatchPixels; ++column) {
      image[row][column] = static_cast<float>(random.uniform());
      turned[column][kPatchPixels - 1 - row] = image[row][column];
    }
  }
  const ResponsePatch a = cornerResponses(image);
  const ResponsePatch b = cornerResponses(turned);
  for (int row = 0; row < kResponsePixels; ++row)
    for (int column = 0; column < kResponsePixels; ++column)
      EXPECT_NEAR(a[row][column], b[column][kResponsePixels - 1 - row], 1e-5F);
}

TEST(CornerResponses, GrowWithTheSquareOfTheContrast) {
  ImagePatch image{};
  ImagePatch faint{};
  for (int row = 0; row < kPatchPixels; ++row) {
    for (int column = 0; column < kPatchPixels; ++column) {
      image[row][column] = row > 20 && column > 20 ? 1.0F : 0.0F;
      faint[row][column] = 0.5F * image[row][column];
    }
  }
  const float strong = cornerResponses(image)[9][9];
  EXPECT_GT(strong, 0.0F);
  EXPECT_NEAR(cornerResponses(faint)[9][9], 0.25F * strong, 1e-6F);
}

TEST(FindResponsePeaks, AreAtTheCornerOnEveryLevel) {
  const auto polyline_m = wallsMeeting(0.5 * M_PI);
  const FeatureDetectorParameters parameters;
  for (int level = 0; level < 3; ++level) {
    const auto peaks = findResponsePeaks(polyline_m, {3.0, 0.0}, level, parameters);
    ASSERT_FALSE(peaks.empty()) << level;
    const ResponsePeak peak = strongest(peaks);
    const double pixel_m = std::ldexp(1.0 / parameters.ppm, level);
    EXPECT_EQ(peak.level, level);
    EXPECT_LT((peak.point_m - Eigen::Vector2d(3.0, 0.0)).norm(), 5.0 * pixel_m);
    EXPECT_GT(peak.cornerness, parameters.corner_threshold);
    EXPECT_LE(peak.cornerness, 0.5);
  }
}

TEST(FindResponsePeaks, DoNotDependOnTheExactPlaceOfTheSearch) {
  const auto polyline_m = wallsMeeting(0.5 * M_PI);
  const FeatureDetectorParameters parameters;
  const ResponsePeak a = strongest(findResponsePeaks(polyline_m, {3.0, 0.0}, 0, parameters));
  const ResponsePeak b = strongest(findResponsePeaks(polyline_m, {2.97, 0.02}, 0, parameters));
  EXPECT_EQ(a.column, b.column);
  EXPECT_EQ(a.row, b.row);
  EXPECT_NEAR(a.min_eigenvalue, b.min_eigenvalue, 1e-3 * a.min_eigenvalue);
  EXPECT_NEAR((a.point_m - b.point_m).norm(), 0.0, 1e-4);
}

TEST(FindResponsePeaks, StraightWallsHaveNoneOfACorner) {
  const auto wall_m = pointsAlong({{3.0, -2.0}, {3.0, 2.0}}, 0.01);
  const FeatureDetectorParameters parameters;
  for (int level = 0; level < 3; ++level) {
    for (const ResponsePeak& peak : findResponsePeaks(wall_m, {3.0, 0.0}, level, parameters))
      EXPECT_LT(peak.cornerness, parameters.corner_threshold) << level;
  }
}

TEST(FindResponsePeaks, FarFromEverythingThereIsNone) {
  EXPECT_TRUE(findResponsePeaks(wallsMeeting(0.5 * M_PI), {-9.0, 5.0}, 0, {}).empty());
}

}  // namespace
}  // namespace ramscout_feature_detector
