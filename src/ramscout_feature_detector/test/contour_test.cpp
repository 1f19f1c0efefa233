// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/contour.hpp"

#include <gtest/gtest.h>

#include "contours.hpp"

namespace ramscout_feature_detector {
namespace {

TEST(Contour, FitOfPointsOnALineIsThatLine) {
  const Contour contour(pointsAlong({{1.0, 2.0}, {4.0, 6.0}}, 0.05));  // 5 m, 101 points
  const LineFit line = contour.fit(0, contour.size() - 1);
  EXPECT_EQ(line.count, 101);
  EXPECT_NEAR((line.centroid_m - Eigen::Vector2d(2.5, 4.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((line.direction - Eigen::Vector2d(0.6, 0.8)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(line.normal().dot(line.direction), 0.0, 1e-15);
  EXPECT_NEAR(line.residual_m2, 0.0, 1e-12);
  // Sum of squares of -50 to 50 times the squared spacing.
  EXPECT_NEAR(line.spread_m2, 2.0 * 50.0 * 51.0 * 101.0 / 6.0 * 0.05 * 0.05, 1e-9);
}

TEST(Contour, FitOfAnyRunIsThatOfItsPointsAlone) {
  ram_slam::Random random(1);
  const auto points_m = noisy(pointsAlong({{2.0, -1.0}, {2.5, 1.0}}, 0.02), 0.01, random);
  const Contour contour(points_m);
  const Contour part({points_m.begin() + 20, points_m.begin() + 61});
  const LineFit a = contour.fit(20, 60);
  const LineFit b = part.fit(0, 40);
  EXPECT_NEAR((a.centroid_m - b.centroid_m).norm(), 0.0, 1e-12);
  EXPECT_NEAR((a.direction - b.direction).norm(), 0.0, 1e-9);
  EXPECT_NEAR(a.residual_m2, b.residual_m2, 1e-12);
  EXPECT_DOUBLE_EQ(contour.residual_m2(20, 60), a.residual_m2);
}

TEST(Contour, ResidualIsTheSmallestOfAllLines) {
  ram_slam::Random random(2);
  const Contour contour(noisy(pointsAlong({{2.0, -1.0}, {2.5, 1.0}}, 0.02), 0.02, random));
  const LineFit best = contour.fit(0, contour.size() - 1);
  const auto residualOf = [&](const Eigen::Vector2d& normal, const Eigen::Vector2d& on_m) {
    double sum_m2 = 0.0;
    for (std::size_t i = 0; i < contour.size(); ++i)
      sum_m2 += std::pow(normal.dot(contour[i] - on_m), 2);
    return sum_m2;
  };
  EXPECT_NEAR(residualOf(best.normal(), best.centroid_m), best.residual_m2, 1e-12);
  for (const double turn_rad : {-0.01, 0.01}) {
    const double angle_rad = std::atan2(best.normal().y(), best.normal().x()) + turn_rad;
    EXPECT_GT(residualOf({std::cos(angle_rad), std::sin(angle_rad)}, best.centroid_m),
              best.residual_m2);
  }
  EXPECT_GT(residualOf(best.normal(), best.centroid_m + 0.01 * best.normal()), best.residual_m2);
}

TEST(Contour, ArcsAreLengthsOfTheSmoothedContour) {
  const Contour straight(pointsAlong({{3.0, -1.0}, {3.0, 1.0}}, 0.01));
  EXPECT_NEAR(straight.length_m(), 2.0, 1e-9);
  EXPECT_EQ(straight.indexAt(0.0), 0U);
  EXPECT_NEAR(straight.arc_m(straight.indexAt(0.5)), 0.5, 0.011);
  EXPECT_EQ(straight.indexAt(99.0), straight.size() - 1);
  ram_slam::Random random(3);
  auto jittered_m = pointsAlong({{3.0, -1.0}, {3.0, 1.0}}, 0.01);
  double raw_m = 0.0;
  jittered_m = noisy(jittered_m, 0.01, random);
  for (std::size_t i = 1; i < jittered_m.size(); ++i)
    raw_m += (jittered_m[i] - jittered_m[i - 1]).norm();
  EXPECT_GT(raw_m, 3.0);
  EXPECT_LT(Contour(jittered_m).length_m(), 2.2);
}

TEST(Contour, NearestIsThePointNearestToAPlace) {
  const Contour contour(pointsAlong({{3.0, -1.0}, {3.0, 1.0}}, 0.5));
  EXPECT_EQ(contour.nearest({0.0, -0.9}), 0U);
  EXPECT_EQ(contour.nearest({9.0, 0.1}), 2U);
  EXPECT_EQ(contour.nearest({3.0, 5.0}), 4U);
}

TEST(Contour, BendsWhereTheDirectionsOfTwoRunsDifferEnough) {
  for (const double turn_deg : {10.0, 40.0, 89.0}) {
    const Contour contour(wallsMeeting(M_PI - turn_deg * M_PI / 180.0));
    const auto bendsBy = [&](double angle_deg) {
      return contour.bendsAt(50, 150, 250, std::cos(2.0 * angle_deg * M_PI / 180.0));
    };
    EXPECT_TRUE(bendsBy(turn_deg - 1.0)) << turn_deg;
    EXPECT_FALSE(bendsBy(turn_deg + 1.0)) << turn_deg;
  }
}

TEST(LineFit, NoiseIsThePriorForFewPointsAndMeasuredForMany) {
  LineFit line;
  line.count = 2;
  EXPECT_DOUBLE_EQ(line.noiseVariance(4.0, 8.0), 4.0);
  line.count = 100002;
  line.residual_m2 = 100000.0;  // variance of one
  EXPECT_NEAR(line.noiseVariance(4.0, 8.0), 1.0, 1e-3);
  EXPECT_GT(line.noiseVariance(4.0, 1e6), 3.0);
}

TEST(LineFit, UncertaintyGrowsAwayFromItsMiddle) {
  LineFit line;
  line.count = 10;
  line.spread_m2 = 2.0;
  EXPECT_DOUBLE_EQ(line.angleVariance(0.5), 0.25);
  EXPECT_DOUBLE_EQ(line.offsetVariance(0.5, {0.0, 7.0}), 0.05);
  EXPECT_DOUBLE_EQ(line.offsetVariance(0.5, {4.0, 0.0}), 0.05 + 0.5 * 16.0 / 2.0);
}

/// On a wall seen at a grazing angle total least squares turns the line; regression along the beams
/// does not.
TEST(Contour, RefinedLinesHaveNoBiasOfRangeNoise) {
  const auto exact_m = pointsAlong({{1.0, 0.5}, {5.0, 0.9}}, 0.2);
  const double true_rad = std::atan2(0.4, 4.0);
  double fitted_rad = 0.0, refined_rad = 0.0;
  const int runs = 4000;
  for (int run = 0; run < runs; ++run) {
    ram_slam::Random random(4, run);
    const Contour contour(noisy(exact_m, 0.05, random));
    const LineFit fit = contour.fit(0, contour.size() - 1);
    const LineFit refined = contour.refine(fit, 0, contour.size() - 1);
    fitted_rad += (std::atan2(fit.direction.y(), fit.direction.x()) - true_rad) / runs;
    refined_rad += (std::atan2(refined.direction.y(), refined.direction.x()) - true_rad) / runs;
  }
  EXPECT_LT(std::abs(refined_rad), std::abs(fitted_rad));
  EXPECT_LT(std::abs(refined_rad), 2e-4);
}

}  // namespace
}  // namespace ramscout_feature_detector
