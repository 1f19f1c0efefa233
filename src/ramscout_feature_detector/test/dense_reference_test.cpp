// SPDX-License-Identifier: BSD-3-Clause
#include "dense_reference.hpp"

#include <gtest/gtest.h>

#include "random_world.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr double kSamePlaceM = 1e-3;
constexpr double kSameResponse = 0.05;

TEST(DenseReference, FindsWhatThePatchesFind) {
  FeatureDetectorParameters parameters;
  parameters.ppm = 50.0;
  const FeatureDetector detector(parameters);
  const DenseReference reference(parameters);
  int expected_count = 0;
  int missed = 0;
  int different = 0;
  int found_count = 0;
  for (int i = 0; i < 6; ++i) {
    const RandomWorld world(static_cast<RandomWorld::Kind>(i % 3), 20 + i);
    ram_slam::Random random(20, i);
    const auto scan = world.walls().scan(world.freePose(random), 0.01, random);
    const auto found = detector.analyse(scan).corners;
    found_count += static_cast<int>(found.size());
    for (const Corner& expected : reference.corners(scan)) {
      ++expected_count;
      const auto same = std::find_if(found.begin(), found.end(), [&](const Corner& corner) {
        return (corner.lines.position_m - expected.lines.position_m).norm() < kSamePlaceM;
      });
      if (same == found.end()) {
        ++missed;
      } else if (std::abs(same->peak.min_eigenvalue - expected.peak.min_eigenvalue) >
                 kSameResponse * expected.peak.min_eigenvalue) {
        ++different;
      }
    }
  }
  EXPECT_GE(expected_count, 30);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(different, 0);
  EXPECT_EQ(found_count, expected_count);
}

TEST(DenseReference, ImageIsTheSame) {
  const FeatureDetectorParameters parameters;
  const std::vector<Eigen::Vector2d> line_m = {{2.0, -1.0}, {2.0, 0.0}, {2.5, 0.3}, {2.6, 0.9}};
  for (int level = 0; level < 3; ++level) {
    const double ppm = std::ldexp(parameters.ppm, -level);
    const int first_column = static_cast<int>(2.0 * ppm) - 20;
    const ImagePatch patch = rasterise(line_m, first_column, -20, level, parameters);
    double brightest = 0.0;
    for (int row = 0; row < kPatchPixels; ++row) {
      for (int column = 0; column < kPatchPixels; ++column) {
        const double expected =
            DenseReference(parameters).intensity(line_m, first_column + column, -20 + row, level);
        EXPECT_NEAR(patch[row][column], expected, 2e-3);
        brightest = std::max(brightest, expected);
      }
    }
    EXPECT_GT(brightest, 0.9);
  }
}

}  // namespace
}  // namespace ramscout_feature_detector
