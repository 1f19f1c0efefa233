// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/surface_scan.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "walls.hpp"

namespace ram_slam {
namespace {

TEST(ExtractSurfaces, NormalsOfAWallPointTowardsTheLaser) {
  const SurfaceScan ahead =
      extractSurfaces(scanWalls({{{3.0, -5.0}, {3.0, 5.0}}}, {}, 1), SurfaceParameters{});
  ASSERT_GT(ahead.points.size(), 50U);
  for (const SurfacePoint& point : ahead.points) {
    EXPECT_NEAR(point.x_m, 3.0, 1e-4);
    EXPECT_NEAR(point.normal_x, -1.0, 1e-3);
    EXPECT_NEAR(point.normal_y, 0.0, 1e-3);
  }
}

TEST(ExtractSurfaces, NoiseAcrossAWallIsReducedByTheFit) {
  TestLaser noisy;
  noisy.range_deviation_m = 0.01;
  const Walls wall{{{2.0, -1.0}, {2.0, 1.0}}};
  const LaserScan scan = scanWalls(wall, {}, 1, noisy);
  const SurfaceScan surfaces = extractSurfaces(scan, SurfaceParameters{});
  double readings = 0.0;
  double fitted = 0.0;
  std::size_t point = 0;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (scan.at(beam) != Return::kHit) continue;
    readings += std::pow(scan.end_m(beam).x() - 2.0, 2);
    fitted += std::pow(surfaces.points[point++].x_m - 2.0, 2);
  }
  EXPECT_LT(fitted, 0.5 * readings);
}

/// Share of a scan's points that lie on a line, and the standard deviation of its normals.
std::pair<double, double> normalsOf(const Walls& walls,
                                    const Eigen::Vector2d& normal,
                                    const TestLaser& laser) {
  const SurfaceScan surfaces = extractSurfaces(scanWalls(walls, {}, 1, laser), {});
  double count = 0.0;
  double squares = 0.0;
  for (const SurfacePoint& point : surfaces.points) {
    if (!point.hasNormal()) continue;
    count += 1.0;
    squares += std::pow(point.normal_x * normal.y() - point.normal_y * normal.x(), 2);
  }
  return {count / static_cast<double>(surfaces.points.size()), std::sqrt(squares / count)};
}

TEST(ExtractSurfaces, NoisyReadingsAreFittedThroughMoreOfThem) {
  TestLaser noisy;
  noisy.range_deviation_m = 0.03;
  const auto [share, deviation_rad] = normalsOf({{{2.0, -1.0}, {2.0, 1.0}}}, {-1.0, 0.0}, noisy);
  EXPECT_GT(share, 0.9);
  // Slope of least squares through readings over 0.6 m, 3.5 cm apart.
  EXPECT_LT(deviation_rad, 1.5 * 0.03 / (0.17 * std::sqrt(17.0)));
}

TEST(ExtractSurfaces, SparseReadingsAreFittedThroughFewOfThem) {
  // With a beam each 3 degrees a niche of 1 m has few readings; they must not be mixed with those
  // of the wall beside it.
  TestLaser sparse;
  sparse.beam_count = 61;
  const Walls walls{
      {{3.0, -6.0}, {3.0, -0.5}}, {{2.6, -0.5}, {2.6, 0.6}}, {{3.0, 0.6}, {3.0, 6.0}}};
  const SurfaceScan surfaces = extractSurfaces(scanWalls(walls, {}, 1, sparse), {});
  int on_niche = 0;
  for (const SurfacePoint& point : surfaces.points) {
    if (point.hasNormal() && std::abs(point.x_m - 2.6) < 0.01 && point.normal_x < -0.999)
      ++on_niche;
  }
  EXPECT_GE(on_niche, 1);
}

TEST(ExtractSurfaces, BeamsKnowTheirPointOrThatOfTheNextHit) {
  const LaserScan scan = scanWalls({{{3.0, -1.0}, {3.0, 1.0}}}, {}, 1);
  const SurfaceScan surfaces = extractSurfaces(scan, SurfaceParameters{});
  ASSERT_EQ(surfaces.point_of_beam.size(), scan.ranges_m.size());
  std::int32_t hits = 0;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    EXPECT_EQ(surfaces.point_of_beam[beam], hits);
    if (scan.at(beam) == Return::kHit) ++hits;
  }
  EXPECT_EQ(surfaces.points.size(), static_cast<std::size_t>(hits));
}

TEST(ExtractSurfaces, LonePointsHaveNoNormal) {
  LaserScan scan = scanWalls({{{3.0, -5.0}, {3.0, 5.0}}}, {}, 1);
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (beam != 180 && beam != 181) scan.ranges_m[beam] = std::numeric_limits<float>::infinity();
  }
  const SurfaceScan surfaces = extractSurfaces(scan, SurfaceParameters{});
  ASSERT_EQ(surfaces.points.size(), 2U);
  EXPECT_FALSE(surfaces.points[0].hasNormal());
  EXPECT_FALSE(surfaces.points[1].hasNormal());
}

TEST(ExtractSurfaces, AWallEndsWhereTheReadingsLeaveAGap) {
  // Two walls, 1 m behind each other: no line leads from one to the other.
  const Walls steps{{{3.0, -2.0}, {3.0, 0.0}}, {{4.0, 0.0}, {4.0, 2.0}}};
  for (const SurfacePoint& point :
       extractSurfaces(scanWalls(steps, {}, 1), SurfaceParameters{}).points) {
    if (!point.hasNormal()) continue;
    EXPECT_NEAR(point.normal_x, -1.0, 1e-3);
  }
}

TEST(ExtractSurfaces, AWallAtAGrazingAngleIsALineAcrossWideGaps) {
  // One beam per degree along a wall 1 m aside: 8 m ahead its readings are 1.1 m apart.
  TestLaser laser;
  laser.field_of_view_rad = M_PI;
  laser.beam_count = 181;
  const LaserScan scan = scanWalls({{{-1.0, 1.0}, {12.0, 1.0}}}, {}, 1, laser);
  SurfaceParameters parameters;
  const auto farthestOnLine = [&] {
    float farthest_m = 0.0F;
    for (const SurfacePoint& point : extractSurfaces(scan, parameters).points)
      if (point.hasNormal()) farthest_m = std::max(farthest_m, point.x_m);
    return farthest_m;
  };
  EXPECT_GT(farthestOnLine(), 7.0F);
  parameters.grazing_gap_factor = 1.0;
  EXPECT_LT(farthestOnLine(), 5.0F);
}

TEST(ExtractSurfaces, ReadingsBeyondTheUsableRangeAreLeftOut) {
  SurfaceParameters parameters;
  parameters.max_range_m = 3.5;
  const SurfaceScan surfaces =
      extractSurfaces(scanWalls({{{3.0, -5.0}, {3.0, 5.0}}}, {}, 1), parameters);
  ASSERT_FALSE(surfaces.points.empty());
  for (const SurfacePoint& point : surfaces.points)
    EXPECT_LE(std::hypot(point.x_m, point.y_m), 3.51);
}

TEST(SurfaceParameters, RefuseValuesOutOfBounds) {
  EXPECT_NO_THROW(SurfaceParameters{}.validate());
  SurfaceParameters parameters;
  parameters.neighbour_count = 1;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
  parameters = {};
  parameters.max_neighbour_count = 2;  // fewer than neighbour_count
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
  parameters = {};
  parameters.max_gap_m = 0.0;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
  parameters = {};
  parameters.max_line_deviation_m = std::nan("");
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
}

TEST(Surfaces, PointsLieOnOneLineIfEachIsNearTheOthers) {
  const SurfacePoint a{1.0F, 0.0F, -1.0F, 0.0F};
  const SurfacePoint beside{1.0F, 2.0F, -1.0F, 0.0F};
  const SurfacePoint behind{1.1F, 0.1F, -1.0F, 0.0F};
  const SurfacePoint bare{1.0F, 0.1F, 0.0F, 0.0F};
  EXPECT_TRUE(lieOnOneLine(a, beside, 0.05));
  EXPECT_FALSE(lieOnOneLine(a, behind, 0.05));
  EXPECT_FALSE(lieOnOneLine(a, bare, 0.05));
}

}  // namespace
}  // namespace ram_slam
