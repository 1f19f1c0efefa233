// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/scan_matching/pose_likelihood.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "walls.hpp"

namespace ram_slam {
namespace {

/// One reading straight ahead, with no line through it.
SurfaceScan oneReading(float range_m) {
  SurfaceScan scan;
  scan.angle_min_rad = -0.01;
  scan.angle_increment_rad = 0.01;
  scan.points = {{range_m, 0.0F, 0.0F, 0.0F}};
  scan.point_of_beam = {0, 0, 1};
  return scan;
}

double logLikelihood(const SurfaceScan& scan, const SurfaceScan& reference, const Pose2& pose) {
  PoseLikelihoodParameters each_counts;
  each_counts.correlated_beams = 1.0;
  return poseLogLikelihood(scan, {{&reference, Pose2{}}}, pose, each_counts);
}

TEST(PoseLikelihood, FallsWithTheSquareOfTheDistanceFromASurface) {
  const SurfaceScan reference = oneReading(2.0F);
  const double deviation_m = PoseLikelihoodParameters().deviation_m;
  EXPECT_NEAR(logLikelihood(reference, reference, {}), 0.0, 1e-9);
  EXPECT_NEAR(logLikelihood(reference, reference, {-0.03, 0.0, 0.0}),
              -0.5 * std::pow(0.03 / deviation_m, 2), 1e-5);
}

TEST(PoseLikelihood, AReadingBehindASurfaceIsNewAndOneInFrontOfItIsSeenThrough) {
  const PoseLikelihoodParameters parameters;
  const SurfaceScan reference = oneReading(2.0F);
  // One is in front of the other and contradicted; seen from there, the other is behind and new.
  const double expected = 0.5 * (std::log(parameters.unseen) + std::log(parameters.contradicting));
  EXPECT_NEAR(logLikelihood(oneReading(3.0F), reference, {}), expected, 1e-9);
  EXPECT_NEAR(logLikelihood(oneReading(1.0F), reference, {}), expected, 1e-9);
}

TEST(PoseLikelihood, AViewOfAnotherSideIsNoEvidenceAgainstThePose) {
  const SurfaceScan reference = oneReading(2.0F);
  EXPECT_NEAR(logLikelihood(reference, reference, {0.0, 0.0, M_PI_2}),
              std::log(PoseLikelihoodParameters().unseen), 1e-9);
}

TEST(PoseLikelihood, ReadingsThatShareTheirErrorCountAsOne) {
  const SurfaceScan reference = oneReading(2.0F);
  const Pose2 pose{-0.03, 0.0, 0.0};
  const double alone = logLikelihood(reference, reference, pose);
  EXPECT_NEAR(poseLogLikelihood(reference, {{&reference, Pose2{}}}, pose, {}), alone / 5.0, 1e-9);
}

TEST(PoseLikelihood, OfSparseScansIsGreatestAtTheTruePose) {
  const Walls walls = outline({{-4, -3}, {6, -3}, {6, 2}, {2, 2}, {2, 5}, {-4, 5}});
  TestLaser sparse;
  sparse.beam_count = 61;
  const Pose2 before{0.0, 0.0, 0.2};
  const Pose2 truth{0.3, 0.1, 0.4};
  const SurfaceScan reference = extractSurfaces(scanWalls(walls, before, 1, sparse), {});
  const SurfaceScan scan = extractSurfaces(scanWalls(walls, truth, 2, sparse), {});
  const auto at = [&](const Pose2& pose) {
    return poseLogLikelihood(scan, {{&reference, before}}, pose, {});
  };
  for (const Pose2& away : {Pose2{0.2, 0.0, 0.0}, Pose2{0.0, 0.2, 0.0}, Pose2{0.0, 0.0, 0.1},
                            Pose2{-0.2, 0.0, 0.0}, Pose2{0.0, -0.2, 0.0}, Pose2{0.0, 0.0, -0.1}})
    EXPECT_GT(at(truth), at(truth * away) + 3.0);
}

}  // namespace
}  // namespace ram_slam
