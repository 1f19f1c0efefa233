// SPDX-License-Identifier: BSD-3-Clause
// What becomes of the filter when one particle has all the weight.
#include <algorithm>
#include <set>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "ram_slam/fast_slam/fast_slam.hpp"

#include "synthetic_world.hpp"

namespace ram_slam {
namespace {

constexpr std::size_t kOvercertainFrom = 100;
constexpr std::size_t kOvercertainTo = 130;
constexpr double kOvercertainVarianceM2 = 1e-8;

/// A tour with features that for three seconds claim to be right to 0.1 mm, and are off by 3 cm.
SyntheticDrive tourWithOvercertainFeatures(std::uint64_t seed) {
  SyntheticDrive drive =
      syntheticDrive(rectangleTour(8.0, 5.0, 2),
                     scatteredLandmarks({-4.0, -4.0}, {14.0, 12.0}, 40, 1.0, seed), 6.0, {}, seed);
  for (std::size_t i = kOvercertainFrom; i < kOvercertainTo; ++i) {
    for (Feature& feature : drive.lists[i].features) {
      feature.covariance_m2 = kOvercertainVarianceM2 * Eigen::Matrix2d::Identity();
    }
  }
  return drive;
}

TEST(FastSlam, GoesOnAfterACollapseToOneParticleAndTellsOfIt) {  // fault F129
  FastSlamParameters parameters;
  parameters.feature_noise_floor = 0.0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SyntheticDrive drive = tourWithOvercertainFeatures(seed);
    FastSlam filter(parameters);
    double fewest = 1e9;
    for (std::size_t i = 0; i < drive.lists.size(); ++i) {
      filter.update(drive.lists[i], drive.odometry);
      fewest = std::min(fewest, filter.quality().effective_fraction * parameters.particle_amount);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(filter.estimate().covariance);
      ASSERT_TRUE(filter.estimate().pose.isFinite()) << i;
      ASSERT_GT(solver.eigenvalues().minCoeff(), -1e-12) << i;
    }
    EXPECT_LT(fewest, 1.3);
    std::set<double> places;
    for (const Particle& particle : filter.particles()) places.insert(particle.map_from_base.x_m);
    EXPECT_GT(places.size(), 10U);
    const Pose2 error = drive.truth.back().inverse() * filter.estimate().pose;
    EXPECT_LT(error.translation().norm(), 0.1) << seed;
  }
}

}  // namespace
}  // namespace ram_slam
