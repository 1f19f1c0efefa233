// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/edge_fits.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "contours.hpp"
#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

const EdgeDetectorParameters kDefaults;

std::vector<Surface> surfacesOf(const ram_slam::LaserScan& scan) {
  return splitIntoSurfaces(scan, kDefaults.distance_threshold, kDefaults.laser_range_sigma,
                           kDefaults.segmentation);
}

/// A quarter of a turn ahead in steps of an eighth of a degree.
ram_slam::LaserScan ahead(const PolygonWorld& world) {
  ram_slam::Random random(1);
  return world.scan({}, 0.0, random, 721, -0.25 * M_PI, M_PI / 1440.0);
}

std::optional<Edge> endOf(const Surface& surface, bool first, const ram_slam::LaserScan& scan) {
  return fitEnd(toContour(surface, 0.4, {}), first, beside(surface, first, scan), scan, kDefaults);
}

TEST(Beside, TheLaserSeesPastTheJambsOfADoor) {
  const auto scan = ahead(door());
  const auto surfaces = surfacesOf(scan);
  ASSERT_EQ(surfaces.size(), 3U);
  EXPECT_FALSE(beside(surfaces[0], true, scan).in_front);  // where the view ends
  const Beside jamb = beside(surfaces[0], false, scan);
  EXPECT_TRUE(jamb.in_front);
  EXPECT_EQ(jamb.next, jamb.beam + 1);
  EXPECT_FALSE(beside(surfaces[1], true, scan).in_front);  // the wall behind is in the shadow
  EXPECT_FALSE(beside(surfaces[1], false, scan).in_front);
  EXPECT_TRUE(beside(surfaces[2], true, scan).in_front);
}

TEST(Beside, OpenSpaceIsBehindAndInvalidReadingsAreNot) {
  PolygonWorld wall;
  wall.add({{3.0, -50.0}, {3.0, 50.0}}, false);
  for (const auto& [value, in_front] :
       {std::make_pair(std::numeric_limits<float>::infinity(), true),
        std::make_pair(std::numeric_limits<float>::quiet_NaN(), false)}) {
    auto scan = ahead(wall);
    scan.ranges_m[360] = value;
    const auto surfaces = surfacesOf(scan);
    ASSERT_EQ(surfaces.size(), 2U);
    EXPECT_EQ(beside(surfaces[0], false, scan).in_front, in_front) << value;
    EXPECT_EQ(beside(surfaces[1], true, scan).in_front, in_front) << value;
  }
}

TEST(FitEnd, JambIsHalfABeamBeyondTheLastReading) {
  const auto scan = ahead(door());
  const auto surfaces = surfacesOf(scan);
  const auto edge = endOf(surfaces[0], false, scan);
  ASSERT_TRUE(edge);
  EXPECT_EQ(edge->kind, Edge::Kind::kEnd);
  EXPECT_TRUE(edge->is_straight);
  EXPECT_NEAR(edge->position_m.x(), 3.0, 1e-4);
  const double bearing_rad = scan.bearing_rad(surfaces[0].beams.back());
  const double spacing_m = 3.0 * (std::tan(bearing_rad + M_PI / 1440.0) - std::tan(bearing_rad));
  EXPECT_NEAR(edge->position_m.y(), 3.0 * std::tan(bearing_rad) + 0.5 * spacing_m, 1e-4);
  EXPECT_NEAR(edge->orientation_rad, M_PI_2, 1e-3);  // where the surface was heading
  // Along the line: one of the places between two beams, all equally likely.
  EXPECT_NEAR(edge->covariance_m2(1, 1),
              spacing_m * spacing_m / 12.0 + kDefaults.two_lines.model_variance_m2, 1e-6);
}

TEST(FitEnd, ThereIsNoneWhereTheNextReadingMayLieOnTheLine) {
  auto scan = ahead(door());
  const auto surfaces = surfacesOf(scan);
  const std::size_t next = surfaces[0].beams.back() + 1;
  // A hit of the same wall, one beam on.
  scan.ranges_m[next] = static_cast<float>(3.0 / std::cos(scan.bearing_rad(next)));
  const Beside past{true, surfaces[0].beams.back(), next};
  EXPECT_FALSE(fitEnd(toContour(surfaces[0], 0.4, {}), false, past, scan, kDefaults));
}

TEST(FitEnd, ThereIsNoneWhereBeamsAreTooFarApart) {
  ram_slam::Random random(1);
  const auto scan = door().scan({}, 0.0, random, 19, -0.25 * M_PI, M_PI / 36.0);  // 26 cm
  for (const Surface& surface : surfacesOf(scan)) {
    if (surface.points_m.size() < LineFit::kFewestPoints) continue;
    const Beside end = beside(surface, false, scan);
    if (!end.in_front) continue;
    EXPECT_FALSE(fitEnd(toContour(surface, 0.4, {}), false, end, scan, kDefaults));
  }
}

Surface across(double distance_m, double width_m, int count) {
  Surface surface;
  for (int i = 0; i < count; ++i) {
    surface.beams.push_back(100 + i);
    surface.points_m.emplace_back(distance_m, width_m * (i / (count - 1.0) - 0.5));
  }
  return surface;
}

TEST(FitObject, MiddleIsBehindWhatIsSeen) {
  const double increment_rad = 0.005;  // 1 cm at 2 m
  const auto edge = fitObject(across(2.0, 0.19, 20), increment_rad, kDefaults);
  ASSERT_TRUE(edge);
  EXPECT_EQ(edge->kind, Edge::Kind::kObject);
  const double width_m = 0.19 + 0.01;
  EXPECT_NEAR(edge->position_m.x(), 2.0 + 0.15 * width_m, 1e-12);
  EXPECT_NEAR(edge->position_m.y(), 0.0, 1e-12);
  const double shared_m2 = 4e-4 / 20.0 + 0.5 * 1e-4 / 12.0 + 2.5e-7;
  EXPECT_NEAR(edge->covariance_m2(0, 0), shared_m2 + std::pow(0.1 * width_m, 2), 1e-12);
  EXPECT_NEAR(edge->covariance_m2(1, 1), shared_m2 + std::pow(0.03 * width_m, 2), 1e-12);
  EXPECT_EQ(edge->orientation_variance_rad2, 1e6);
}

TEST(FitObject, ThereIsNoneIfTheBeamsAreTooFarApart) {
  EXPECT_TRUE(fitObject(across(2.0, 0.19, 4), 0.005, kDefaults));
  EXPECT_FALSE(fitObject(across(2.0, 0.19, 4), 0.1, kDefaults));
}

TEST(FindCorners, FindsTheCornerOfTwoWallsAndNothingElse) {
  const Contour contour(wallsMeeting(0.5 * M_PI));
  const auto corners = findCorners(contour, kDefaults);
  ASSERT_EQ(corners.size(), 1U);
  EXPECT_EQ(corners[0].kind, Edge::Kind::kBend);
  EXPECT_TRUE(corners[0].is_straight);
  EXPECT_NEAR((corners[0].position_m - Eigen::Vector2d(3.0, 0.0)).norm(), 0.0, 1e-4);
}

TEST(FindCorners, ThresholdsDecideWhatIsACorner) {
  const Contour contour(wallsMeeting(140.0 * M_PI / 180.0));  // cornerness 0.117
  EXPECT_EQ(findCorners(contour, kDefaults).size(), 1U);
  EdgeDetectorParameters sharp;
  sharp.corner_threshold = 0.13;
  EXPECT_TRUE(findCorners(contour, sharp).empty());
  EdgeDetectorParameters clear;
  clear.bends.corner_gain = 1e6;
  EXPECT_TRUE(findCorners(contour, clear).empty());
}

}  // namespace
}  // namespace ramscout_feature_detector
