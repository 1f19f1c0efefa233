// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/pose_hypotheses.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "walls.hpp"

namespace ram_slam {
namespace {

/// Wheels that predict `predicted` with these deviations.
PosePrior prior(const Pose2& predicted, double deviation_m, double deviation_rad) {
  PosePrior prior{predicted, Eigen::Matrix3d::Zero()};
  prior.information.diagonal() << std::pow(deviation_m, -2), std::pow(deviation_m, -2),
      std::pow(deviation_rad, -2);
  return prior;
}

/// Wheels that slip with a hundred times their variance.
PoseHypotheses::Wheels slipping(const PosePrior& wheels) {
  return {wheels, wheels.information / 100.0};
}

/// The pose that a search about wrong wheels chooses in a room, where the robot is at `truth`.
PoseHypotheses::Hypothesis chosen(const Walls& walls,
                                  const Pose2& truth,
                                  const PosePrior& wheels,
                                  const PoseHypotheses::Settings& settings = {}) {
  const Pose2 before{-1.0, 0.0, 0.3};
  const SurfaceScan reference = extractSurfaces(scanWalls(walls, before, 1), {});
  const SurfaceScan scan = extractSurfaces(scanWalls(walls, truth, 2), {});
  PoseHypotheses hypotheses(scan, {{&reference, before}}, slipping(wheels), settings);
  hypotheses.search(3.2);
  return hypotheses.best();
}

double distance(const Pose2& a, const Pose2& b) {
  const Pose2 between = a.inverse() * b;
  return between.translation().norm() + std::abs(between.yaw_rad);
}

const Walls kRoom = outline({{-4, -3}, {6, -3}, {6, 2}, {2, 2}, {2, 5}, {-4, 5}});
const Walls kCorridor = {{{-100, -1}, {100, -1}}, {{-100, 1}, {100, 1}}};

TEST(PoseHypotheses, BeginWithThePredictionOfTheWheels) {
  const SurfaceScan empty;
  const PoseHypotheses::Settings settings;
  const PosePrior wheels = prior({1.0, 2.0, 0.5}, 0.02, 0.01);
  const PoseHypotheses hypotheses(empty, {}, slipping(wheels), settings);
  EXPECT_EQ(distance(hypotheses.best().match.map_from_laser, wheels.map_from_laser), 0.0);
  EXPECT_EQ(hypotheses.best().match.information.norm(), 0.0);
  EXPECT_FALSE(hypotheses.best().searched);
}

TEST(PoseHypotheses, FindARobotWhoseWheelsMissedATurn) {
  const Pose2 truth{-0.9, 0.1, 1.1};
  const auto best = chosen(kRoom, truth, prior({-0.9, 0.1, 0.4}, 0.02, 0.02));
  EXPECT_TRUE(best.searched);
  EXPECT_LT(distance(best.match.map_from_laser, truth), 0.01);
}

TEST(PoseHypotheses, StayWithTheWheelsIfTooFewPointsAreInRange) {
  const Pose2 truth{-0.9, 0.1, 1.1};
  const PosePrior wheels = prior({-0.9, 0.1, 0.4}, 0.02, 0.02);
  PoseHypotheses::Settings settings;
  settings.search.max_range_m = 0.5;
  EXPECT_FALSE(chosen(kRoom, truth, wheels, settings).searched) << "all walls are farther";
  settings.search.max_range_m = 30.0;
  settings.search.min_points = 1000;
  EXPECT_FALSE(chosen(kRoom, truth, wheels, settings).searched);
}

TEST(PoseHypotheses, DependOnTheScatterOfASlipNotOnThatOfGoodWheels) {
  // A turn of 0.3 rad that the scan shows: thirty deviations of good wheels, three of a slip.
  const SurfaceScan reference = extractSurfaces(scanWalls(kRoom, {}, 1), {});
  const PosePrior wheels = prior({0.0, 0.0, 0.3}, 0.02, 0.01);
  const auto isTaken = [&](double slip_rad) {
    PoseHypotheses::Settings settings;
    settings.anywhere_probability = 1e-100;
    const Eigen::Matrix3d slip = prior({}, 0.2, slip_rad).information;
    PoseHypotheses hypotheses(reference, {{&reference, Pose2{}}}, {wheels, slip}, settings);
    ScanMatch by_scan;
    hypotheses.add(by_scan);
    return hypotheses.best().match.map_from_laser.yaw_rad == 0.0;
  };
  EXPECT_TRUE(isTaken(0.1));
  EXPECT_FALSE(isTaken(0.01));
}

TEST(PoseHypotheses, StayWithTheWheelsWhereTheScanFitsAnywhere) {
  // Half a metre farther, or turned about, a corridor is the same.
  const PosePrior wheels = prior({-0.5, 0.0, 0.3}, 0.02, 0.02);
  const auto best = chosen(kCorridor, {-0.5, 0.0, 0.3}, wheels);
  EXPECT_LT(distance(best.match.map_from_laser, wheels.map_from_laser), 0.02);
}

TEST(PoseHypotheses, StayWithTheWheelsThatLeadWhereNothingWasSeenYet) {
  // Turned about, the robot sees the other half of the corridor: that is no evidence against it.
  const Pose2 truth{-1.0, 0.1, 0.3 + 3.0};
  const auto best = chosen(kCorridor, truth, prior(truth, 0.1, 0.2));
  EXPECT_LT(distance(best.match.map_from_laser, truth), 0.1);
}

TEST(PoseHypotheses, FindATurnInACorridorAndLeaveThePlaceAlongItOpen) {
  // The walls show how far the robot turned, and nothing of where it is along them.
  const Pose2 truth{-0.9, 0.1, 1.0};
  const auto best = chosen(kCorridor, truth, prior({-0.9, 0.1, 0.3}, 0.02, 0.02));
  EXPECT_NEAR(best.match.map_from_laser.yaw_rad, truth.yaw_rad, 0.01);
  EXPECT_NEAR(best.match.map_from_laser.y_m, truth.y_m, 0.01);
  const Eigen::Matrix3d& information = best.match.information;
  EXPECT_LT(information(0, 0), 1e-2 * information(1, 1));
}

TEST(PoseHypotheses, PreciseWheelsNeedMoreEvidenceAgainstThem) {
  const SurfaceScan reference = extractSurfaces(scanWalls(kRoom, {}, 1), {});
  const PoseHypotheses::Settings settings;
  ScanMatch other;
  other.map_from_laser = {};
  const auto isTaken = [&](double deviation_m) {
    const PosePrior wheels = prior({0.09, 0.0, 0.0}, deviation_m, 0.01);
    PoseHypotheses hypotheses(reference, {{&reference, Pose2{}}}, slipping(wheels), settings);
    hypotheses.add(other);
    return hypotheses.best().match.map_from_laser.x_m == 0.0;
  };
  EXPECT_TRUE(isTaken(0.03));
  EXPECT_FALSE(isTaken(0.001));
}

}  // namespace
}  // namespace ram_slam
