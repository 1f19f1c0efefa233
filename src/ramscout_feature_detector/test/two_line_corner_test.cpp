// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/two_line_corner.hpp"

#include <algorithm>
#include <cstdlib>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "contours.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr double kSigmaM = 0.01;

CornerModel model(const TwoLineParameters& tuning) {
  return {kSigmaM, 0.08, 16.0, tuning};
}

class Opening : public testing::TestWithParam<double> {
protected:
  TwoLineParameters tuning_;
  double opening_rad_ = GetParam() * M_PI / 180.0;
  Contour contour_{wallsMeeting(opening_rad_)};
};

INSTANTIATE_TEST_SUITE_P(Degrees, Opening, testing::Values(60.0, 90.0, 120.0, 140.0));

TEST_P(Opening, SplitIsWhereTheWallsMeet) {
  const auto splits = findSplits(contour_, tuning_);
  ASSERT_FALSE(splits.empty());
  long nearest = 1000;
  for (const std::size_t split : splits)
    nearest = std::min(nearest, std::labs(static_cast<long>(split) - 150));
  EXPECT_LE(nearest, 1);
}

TEST_P(Opening, CornerOfExactPointsIsExact) {
  const auto corner = fitCorner(contour_, 150, model(tuning_));
  ASSERT_TRUE(corner);
  EXPECT_NEAR((corner->position_m - Eigen::Vector2d(3.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(corner->cornerness, 0.5 * (1.0 - std::abs(std::cos(opening_rad_))), 1e-6);
  EXPECT_NEAR(std::abs(corner->orientation_rad), M_PI, 1e-6);  // between the walls: to the laser
  EXPECT_EQ(corner->split, 150U);
}

TEST_P(Opening, CornerIsPromising) {
  EXPECT_TRUE(isPromising(contour_, 150, model(tuning_)));
  EXPECT_FALSE(isPromising(contour_, 75, model(tuning_)));
}

TEST_P(Opening, ErrorsAreAsLargeAsTheCovarianceStates) {
  double sum = 0.0;
  int count = 0;
  const int runs = 400;
  for (int run = 0; run < runs; ++run) {
    ram_slam::Random random(5, run);
    const Contour contour(noisy(wallsMeeting(opening_rad_), kSigmaM, random));
    const auto corner = fitCorner(contour, 150, model(tuning_));
    if (!corner) continue;
    const Eigen::Vector2d error_m = corner->position_m - Eigen::Vector2d(3.0, 0.0);
    sum += error_m.dot(corner->covariance_m2.inverse() * error_m);
    ++count;
  }
  EXPECT_GT(count, 0.9 * runs);
  EXPECT_NEAR(sum / count, 2.0, 0.5);
}

/// Short legs of a noisy wall may bend; the image rejects those.
TEST(FitCorner, StraightWallsSeldomHaveOne) {
  const TwoLineParameters tuning;
  int walls_with_corner = 0;
  for (int run = 0; run < 200; ++run) {
    ram_slam::Random random(6, run);
    const Contour wall(noisy(pointsAlong({{3.0, -1.5}, {3.0, 1.5}}, 0.01), kSigmaM, random));
    const auto splits = findSplits(wall, tuning);
    walls_with_corner += std::any_of(splits.begin(), splits.end(), [&](std::size_t split) {
      const auto corner = fitCorner(wall, split, model(tuning));
      return corner && corner->cornerness >= 0.08 && corner->significance >= 16.0;
    });
  }
  EXPECT_LE(walls_with_corner, 30);
}

TEST(FitCorner, NeedsBothLegs) {
  const TwoLineParameters tuning;
  const Contour contour(wallsMeeting(0.5 * M_PI));
  EXPECT_FALSE(fitCorner(contour, 1, model(tuning)));
  EXPECT_FALSE(fitCorner(contour, contour.size() - 3, model(tuning)));
}

TEST(FitCorner, NeedsLegsThatAreSeenUpToTheCorner) {
  const TwoLineParameters tuning;
  auto points_m = wallsMeeting(0.5 * M_PI);
  points_m.erase(points_m.begin() + 135, points_m.begin() + 166);  // 15 cm of each are hidden
  EXPECT_FALSE(fitCorner(Contour(points_m), 134, model(tuning)));
  TwoLineParameters tolerant;
  tolerant.unseen_sigmas = 20.0;
  EXPECT_TRUE(fitCorner(Contour(points_m), 134, model(tolerant)));
}

TEST(LongestLeg, IsTheLongestStraightOneThatIsTried) {
  const TwoLineParameters tuning;
  const Contour contour(wallsMeeting(0.5 * M_PI));
  const auto leg = longestLeg(contour, 150, true, model(tuning));
  ASSERT_TRUE(leg);
  EXPECT_TRUE(leg->before);
  EXPECT_EQ(leg->last, 150U);
  EXPECT_NEAR((contour[leg->last] - contour[leg->first]).norm(), 0.8, 0.05);
  TwoLineParameters shorter;
  shorter.leg_lengths_m = {0.1, 0.3};
  const auto short_leg = longestLeg(contour, 150, false, model(shorter));
  ASSERT_TRUE(short_leg);
  EXPECT_EQ(short_leg->first, 150U);
  EXPECT_NEAR((contour[short_leg->last] - contour[short_leg->first]).norm(), 0.3, 0.05);
}

TEST(LongestLeg, DoesNotGoAroundACorner) {
  const TwoLineParameters tuning;
  const Contour contour(wallsMeeting(0.5 * M_PI));
  const auto leg = longestLeg(contour, 120, false, model(tuning));  // 0.3 m before the corner
  ASSERT_TRUE(leg);
  EXPECT_LE(leg->last, 152U);
}

TEST(LongestLeg, NeedsPointsAndALengthBeyondTheNoise) {
  const TwoLineParameters tuning;
  const Contour sparse({{3.0, -1.0}, {3.0, 0.0}, {3.0, 1.0}});
  EXPECT_FALSE(longestLeg(sparse, 1, true, model(tuning)));
  const Contour contour(wallsMeeting(0.5 * M_PI));
  const CornerModel noisy_sensor{0.1, 0.08, 16.0, tuning};  // needs 1 m
  EXPECT_FALSE(longestLeg(contour, 150, true, noisy_sensor));
}

TEST(NoiseOf, ShrinksWithTheIncidenceOfTheBeams) {
  TwoLineParameters tuning;
  tuning.line.noise_prior_points = 1e9;  // the prior alone
  const auto noiseOfWall = [&](const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    const Contour wall(pointsAlong({from_m, to_m}, 0.01));
    return noiseOf(wall.fit(0, wall.size() - 1), model(tuning));
  };
  EXPECT_NEAR(noiseOfWall({3.0, -0.5}, {3.0, 0.5}), 1e-4, 1e-9);
  EXPECT_NEAR(noiseOfWall({2.5, 2.5}, {3.5, 3.5}), 1e-4 * 0.09, 1e-9);  // along the beam
  EXPECT_NEAR(noiseOfWall({3.0, 2.5}, {3.0, 3.5}), 1e-4 * 0.5, 1e-9);   // at 45 degrees
}

}  // namespace
}  // namespace ramscout_feature_detector
