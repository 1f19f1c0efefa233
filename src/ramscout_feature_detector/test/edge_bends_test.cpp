// SPDX-License-Identifier: BSD-3-Clause
// findBends(): what the edge detector finds where legs are not straight.
#include <gtest/gtest.h>

#include "ramscout_feature_detector/edge_fits.hpp"

#include "contours.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr double kIncrementRad = 0.0025;

std::vector<Edge> bendsOf(const Contour& contour, const EdgeDetectorParameters& parameters = {}) {
  return findBends(contour, kIncrementRad, parameters);
}

TEST(FindBends, FindsASharpTurnAtTheCrossingOfItsArms) {
  for (const double opening_deg : {60.0, 90.0, 120.0}) {
    const auto bends = bendsOf(Contour(wallsMeeting(opening_deg * M_PI / 180.0)));
    ASSERT_EQ(bends.size(), 1U) << opening_deg;
    EXPECT_EQ(bends[0].kind, Edge::Kind::kBend);
    EXPECT_FALSE(bends[0].is_straight);
    EXPECT_LT((bends[0].position_m - Eigen::Vector2d(3.0, 0.0)).norm(), 0.01);
    EXPECT_NEAR(std::abs(bends[0].orientation_rad), M_PI, 0.01);
  }
}

TEST(FindBends, BendAngleDecidesWhatIsSharp) {
  const Contour contour(wallsMeeting(130.0 * M_PI / 180.0));  // turns by 50 degrees
  EdgeDetectorParameters parameters;
  parameters.bend_angle = 45.0 * M_PI / 180.0;
  EXPECT_EQ(bendsOf(contour, parameters).size(), 1U);
  parameters.bend_angle = 55.0 * M_PI / 180.0;
  EXPECT_TRUE(bendsOf(contour, parameters).empty());
}

TEST(FindBends, StraightAndGentlyCurvedSurfacesHaveNone) {
  EXPECT_TRUE(bendsOf(Contour(pointsAlong({{3.0, -1.0}, {3.0, 1.0}}, 0.01))).empty());
  std::vector<Eigen::Vector2d> arc_m;  // 2 m radius: 0.2 rad over both arms
  for (int i = 0; i < 200; ++i) {
    const double angle_rad = M_PI - 0.5 + 0.005 * i;
    arc_m.emplace_back(4.0 + 2.0 * std::cos(angle_rad), -2.0 * std::sin(angle_rad));
  }
  EXPECT_TRUE(bendsOf(Contour(arc_m)).empty());
}

TEST(FindBends, RoundedCornerIsOneBend) {
  auto points_m = pointsAlong({{3.0, -1.0}, {3.0, -0.1}}, 0.01);
  for (int i = 1; i < 16; ++i) {
    const double angle_rad = i * M_PI / 32.0;  // a quarter of a circle of 10 cm
    points_m.emplace_back(2.9 + 0.1 * std::cos(angle_rad), -0.1 + 0.1 * std::sin(angle_rad));
  }
  for (const auto& point_m : pointsAlong({{2.9, 0.0}, {2.0, 0.0}}, 0.01))
    points_m.push_back(point_m);
  const auto bends = bendsOf(Contour(points_m));
  ASSERT_EQ(bends.size(), 1U);
  EXPECT_LT((bends[0].position_m - Eigen::Vector2d(2.97, -0.03)).norm(), 0.05);
}

TEST(FindBends, CovarianceHoldsNoiseSamplingAndRaggedness) {
  EdgeDetectorParameters parameters;
  const auto bends = bendsOf(Contour(wallsMeeting(0.5 * M_PI)), parameters);
  ASSERT_EQ(bends.size(), 1U);
  const double spacing_m = bends[0].position_m.norm() * kIncrementRad;
  const double expected_m2 = 4e-4 + spacing_m * spacing_m / 12.0;
  EXPECT_NEAR(bends[0].covariance_m2(0, 0), expected_m2 + 4e-4, 1e-12);
  EXPECT_EQ(bends[0].covariance_m2(0, 1), 0.0);
  parameters.bends.ragged_variance_m2 = 9e-4;
  EXPECT_NEAR(bendsOf(Contour(wallsMeeting(0.5 * M_PI)), parameters)[0].covariance_m2(0, 0),
              expected_m2 + 9e-4, 1e-12);
}

TEST(FindBends, UncertainOnesAreLeftOut) {
  EdgeDetectorParameters parameters;
  parameters.position_sigma_limit = 0.021;
  EXPECT_EQ(bendsOf(Contour(wallsMeeting(0.5 * M_PI)), parameters).size(), 1U);
  parameters.position_sigma_limit = 0.019;  // less than the noise of a reading
  EXPECT_TRUE(bendsOf(Contour(wallsMeeting(0.5 * M_PI)), parameters).empty());
}

TEST(FindBends, TwoLinesMustDescribeABendBetterByTheirGain) {
  EdgeDetectorParameters parameters;
  parameters.bends.bend_gain = 1e6;
  EXPECT_TRUE(bendsOf(Contour(wallsMeeting(0.5 * M_PI)), parameters).empty());
}

TEST(FindBends, TwoTurnsFartherApartThanTheScaleAreTwoBends) {
  const auto steps = [](double width_m) {
    return Contour(
        pointsAlong({{3.0, -1.0}, {3.0, 0.0}, {3.0 - width_m, 0.0}, {3.0 - width_m, 1.0}}, 0.01));
  };
  EXPECT_EQ(bendsOf(steps(0.5)).size(), 2U);
}

}  // namespace
}  // namespace ramscout_feature_detector
