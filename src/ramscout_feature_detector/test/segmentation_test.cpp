// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_feature_detector/segmentation.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "polygon_world.hpp"

namespace ramscout_feature_detector {
namespace {

constexpr double kThresholdM = 0.3;
constexpr double kSigmaM = 0.01;

std::vector<Surface> surfacesOf(const ram_slam::LaserScan& scan,
                                const SegmentationParameters& parameters = {}) {
  return splitIntoSurfaces(scan, kThresholdM, kSigmaM, parameters);
}

ram_slam::LaserScan exactScan(const PolygonWorld& world, int beams = 721) {
  ram_slam::Random random(1);
  return world.scan({}, 0.0, random, beams, -0.25 * M_PI, 0.5 * M_PI / (beams - 1));
}

PolygonWorld wall() {
  PolygonWorld world;
  world.add({{3.0, -50.0}, {3.0, 50.0}}, false);
  return world;
}

PolygonWorld room() {
  PolygonWorld world;
  world.add({{-2.0, -3.0}, {4.0, -3.0}, {4.0, 2.0}, {-2.0, 2.0}}, true);
  return world;
}

ram_slam::LaserScan fullTurn(const PolygonWorld& world) {
  ram_slam::Random random(1);
  return world.scan({}, 0.0, random, 720, -M_PI, 2.0 * M_PI / 720);
}

TEST(SplitIntoSurfaces, OneWallIsOneSurfaceOfAllItsBeams) {
  const auto surfaces = surfacesOf(exactScan(wall()));
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_EQ(surfaces[0].beams.size(), 721U);
  EXPECT_EQ(surfaces[0].points_m.size(), 721U);
  EXPECT_FALSE(surfaces[0].closed);
}

TEST(SplitIntoSurfaces, CutsWhereTheRangeJumps) {
  const auto surfaces = surfacesOf(exactScan(door()));
  ASSERT_EQ(surfaces.size(), 3U);
  EXPECT_NEAR(surfaces[0].points_m.back().y(), -0.5, 0.01);
  EXPECT_NEAR(surfaces[1].points_m.front().x(), 6.0, 1e-5);
  EXPECT_NEAR(surfaces[2].points_m.front().y(), 0.5, 0.01);
}

TEST(SplitIntoSurfaces, CutsAtReadingsWithoutInformation) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 0.0F}) {
    auto scan = exactScan(wall());
    scan.ranges_m[300] = value;
    const auto surfaces = surfacesOf(scan);
    ASSERT_EQ(surfaces.size(), 2U) << value;
    EXPECT_EQ(surfaces[0].beams.back(), 299U);
    EXPECT_EQ(surfaces[1].beams.front(), 301U);
  }
}

TEST(SplitIntoSurfaces, LoneReadingsAreLeftOutAndTheirSurfaceContinued) {
  auto scan = exactScan(wall());
  scan.ranges_m[300] = 1.0F;
  const auto surfaces = surfacesOf(scan);
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_EQ(surfaces[0].beams.size(), 720U);
  SegmentationParameters strict;
  strict.max_bridged_beams = 0;
  EXPECT_EQ(surfacesOf(scan, strict).size(), 2U);
  SegmentationParameters tolerant;
  tolerant.lone_reading_m = 5.0;
  EXPECT_EQ(surfacesOf(scan, tolerant).size(), 3U);  // a surface of its own
}

TEST(SplitIntoSurfaces, GrazingWallsAreNotCutUpToTheirAngle) {
  PolygonWorld corridor;
  corridor.add({{-1.0, 0.5}, {25.0, 0.5}}, false);
  ram_slam::Random random(1);
  const auto scan = corridor.scan({}, 0.0, random, 46, 0.0, M_PI / 90.0);  // 2 degrees
  const auto reachOf_m = [&](const SegmentationParameters& parameters) {
    return surfacesOf(scan, parameters).back().points_m.front().norm();
  };
  SegmentationParameters usual;
  usual.lone_reading_m = 5.0;  // these readings are all far apart in range
  EXPECT_GE(reachOf_m(usual), 0.5 / std::sin(12.0 * M_PI / 180.0) - 1e-3);
  SegmentationParameters steep = usual;
  steep.grazing_angle_rad = 0.5 * M_PI - 0.1;
  EXPECT_LT(reachOf_m(steep), 0.5 / std::sin(12.0 * M_PI / 180.0) - 1e-3);
}

TEST(SplitIntoSurfaces, FullTurnsAreJoinedAtTheirSeam) {
  const auto scan = fullTurn(room());
  EXPECT_TRUE(isFullTurn(scan));
  const auto surfaces = surfacesOf(scan);
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_TRUE(surfaces[0].closed);

  auto interrupted = scan;
  interrupted.ranges_m[200] = std::numeric_limits<float>::infinity();
  const auto joined = surfacesOf(interrupted);
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_FALSE(joined[0].closed);
  EXPECT_EQ(joined[0].beams.front(), 201U);
  EXPECT_EQ(joined[0].beams.back(), 199U);
}

TEST(SplitIntoSurfaces, PartOfATurnHasNoSeam) {
  EXPECT_FALSE(isFullTurn(exactScan(room())));
  for (const Surface& surface : surfacesOf(exactScan(room()))) EXPECT_FALSE(surface.closed);
}

TEST(SplitIntoSurfaces, ReadingsBeyondTheLimitAreNotUsed) {
  SegmentationParameters near;
  near.max_range_m = 2.0;
  EXPECT_TRUE(surfacesOf(exactScan(wall()), near).empty());
  EXPECT_TRUE(surfacesOf(exactScan(PolygonWorld{})).empty());
}

TEST(ToContour, ClosedSurfacesRepeatTheirBeginning) {
  auto surfaces = surfacesOf(fullTurn(room()));
  const std::size_t count = surfaces[0].points_m.size();
  const Eigen::Vector2d first_m = surfaces[0].points_m[0];
  const Contour contour = toContour(std::move(surfaces[0]), 1.0, {});
  EXPECT_TRUE(contour.closed());
  EXPECT_GT(contour.size(), count);
  EXPECT_EQ(contour[count], first_m);
  EXPECT_GE((contour.back() - contour[count]).norm(), 0.9);
}

TEST(SplitIntoContours, DropsWhatCornersCannotLieOn) {
  const FeatureDetectorParameters parameters;
  PolygonWorld post;
  post.add({{2.0, -0.1}, {2.0, 0.1}}, false);  // shorter than twice occlude_limit
  EXPECT_TRUE(splitIntoContours(exactScan(post), parameters).empty());
  EXPECT_EQ(splitIntoContours(exactScan(wall()), parameters).size(), 1U);
  EXPECT_TRUE(splitIntoContours(exactScan(wall(), 4), parameters).empty());  // four points
}

}  // namespace
}  // namespace ramscout_feature_detector
