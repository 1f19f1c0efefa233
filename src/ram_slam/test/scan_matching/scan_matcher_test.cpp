// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/scan_matcher.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include "walls.hpp"

namespace ram_slam {
namespace {

Walls room() {
  return outline({{-4, -3}, {6, -3}, {6, 2}, {2, 2}, {2, 5}, {-4, 5}});
}

SurfaceScan surfacesFrom(const Walls& walls, const Pose2& map_from_laser) {
  return extractSurfaces(scanWalls(walls, map_from_laser, 1), SurfaceParameters{});
}

TEST(MatchScan, FindsThePoseFromAGuessNearby) {
  const Pose2 truth{0.12, -0.08, 0.06};
  const SurfaceScan reference = surfacesFrom(room(), {});
  const SurfaceScan scan = surfacesFrom(room(), truth);
  const ScanMatch match = matchScan(scan, {{&reference, {}}}, {}, {}, ScanMatcherParameters{});
  EXPECT_NEAR(match.map_from_laser.x_m, truth.x_m, 1e-3);
  EXPECT_NEAR(match.map_from_laser.y_m, truth.y_m, 1e-3);
  EXPECT_NEAR(match.map_from_laser.yaw_rad, truth.yaw_rad, 1e-3);
  EXPECT_GT(match.inlier_ratio, 0.9);
}

TEST(MatchScan, DoesNotDependOnTheAxesOfTheMap) {
  const Pose2 map_from_reference{10.0, -3.0, 2.0};
  const Pose2 truth{0.05, 0.04, -0.03};
  const SurfaceScan reference = surfacesFrom(room(), {});
  const SurfaceScan scan = surfacesFrom(room(), truth);
  const ScanMatch match = matchScan(scan, {{&reference, map_from_reference}}, {},
                                    map_from_reference, ScanMatcherParameters{});
  const Pose2 found = map_from_reference.inverse() * match.map_from_laser;
  EXPECT_NEAR(found.x_m, truth.x_m, 1e-3);
  EXPECT_NEAR(found.y_m, truth.y_m, 1e-3);
  EXPECT_NEAR(found.yaw_rad, truth.yaw_rad, 1e-3);
}

TEST(MatchScan, HasNoInformationAlongACorridor) {
  const Walls corridor{{{-100, -1}, {100, -1}}, {{-100, 1}, {100, 1}}};
  const SurfaceScan scan = surfacesFrom(corridor, {});
  const ScanMatch match = matchScan(scan, {{&scan, {}}}, {}, {}, ScanMatcherParameters{});
  EXPECT_LT(match.information(0, 0), 1e-6 * match.information(1, 1));
}

TEST(MatchScan, FollowsThePriorWhereTheScanHasNoInformation) {
  const Walls corridor{{{-100, -1}, {100, -1}}, {{-100, 1}, {100, 1}}};
  const SurfaceScan scan = surfacesFrom(corridor, {});
  PosePrior prior;
  prior.map_from_laser = {0.2, 0.0, 0.0};
  prior.information = 100.0 * Eigen::Matrix3d::Identity();
  const ScanMatch match = matchScan(scan, {{&scan, {}}}, prior, {}, ScanMatcherParameters{});
  EXPECT_NEAR(match.map_from_laser.x_m, 0.2, 1e-3);
  EXPECT_NEAR(match.map_from_laser.y_m, 0.0, 1e-3);
}

TEST(MatchScan, WithoutReferencesIsThePrior) {
  const SurfaceScan scan = surfacesFrom(room(), {});
  PosePrior prior;
  prior.map_from_laser = {1.0, 2.0, 0.5};
  prior.information = Eigen::Matrix3d::Identity();
  const ScanMatch match = matchScan(scan, {}, prior, {0.9, 2.1, 0.4}, ScanMatcherParameters{});
  EXPECT_NEAR(match.map_from_laser.x_m, 1.0, 1e-4);
  EXPECT_NEAR(match.map_from_laser.y_m, 2.0, 1e-4);
  EXPECT_NEAR(match.map_from_laser.yaw_rad, 0.5, 1e-4);
  EXPECT_EQ(match.inlier_ratio, 0.0);
}

TEST(MatchScan, TheSameReferenceTwiceGivesNoMoreInformation) {
  const SurfaceScan scan = surfacesFrom(room(), {});
  const ScanMatcherParameters parameters;
  const ScanMatch once = matchScan(scan, {{&scan, {}}}, {}, {}, parameters);
  const ScanMatch twice = matchScan(scan, {{&scan, {}}, {&scan, {}}}, {}, {}, parameters);
  EXPECT_TRUE(twice.information.isApprox(once.information, 1e-9));
}

TEST(ScanMatcherParameters, RefuseValuesOutOfBounds) {
  EXPECT_NO_THROW(ScanMatcherParameters{}.validate());
  ScanMatcherParameters parameters;
  parameters.last_gate_m = 2.0 * parameters.first_gate_m;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
  parameters = {};
  parameters.min_normal_cosine = 1.1;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
  parameters = {};
  parameters.correlated_beams = 0.5;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
  parameters = {};
  parameters.gate_shrink = 1.0;  // the gate would never become the last one
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
