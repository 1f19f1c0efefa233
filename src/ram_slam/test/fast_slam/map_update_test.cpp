// SPDX-License-Identifier: BSD-3-Clause
// FastSlam::updateMaps() and resample(): what happens to the particles' maps.
#include <cmath>

#include <gmock/gmock.h>

#include "fast_slam_fixtures.hpp"

namespace ram_slam {
namespace {

/// A robot that stands still and knows it.
class Still : public MotionModel {
public:
  PoseWithCovariance2 motion(std::int64_t, std::int64_t) const override { return {}; }
};

constexpr double kVariance_m2 = 0.0009;

TEST(UpdateMaps, CreateALandmarkOnceForAllParticles) {
  FastSlam filter(plain());
  filter.update(oneFeature(1000, {2.0, 1.0}, kVariance_m2), Still());
  ASSERT_EQ(filter.registry().records().size(), 1U);
  EXPECT_EQ(filter.registry().records()[0].placed_ns, 1000);
  EXPECT_NEAR(filter.registry().records()[0].seen_within_m, std::sqrt(5.0), 1e-12);
  for (const Particle& particle : filter.particles()) {
    const Landmark* landmark = particle.landmarks.find(0);
    ASSERT_NE(landmark, nullptr);
    EXPECT_TRUE(landmark->mean_m.isApprox(Eigen::Vector2d(2.0, 1.0), 1e-12));
    EXPECT_TRUE(landmark->covariance_m2.isApprox(kVariance_m2 * Eigen::Matrix2d::Identity(), 1e-9));
  }
}

TEST(UpdateMaps, FuseReadingsAsTheMeanOfIndependentMeasurements) {
  FastSlam filter(plain());
  const std::vector<double> distances_m = {2.0, 2.02, 1.99, 2.03};
  double sum_m = 0.0;
  std::int64_t stamp_ns = 0;
  for (const double distance_m : distances_m) {
    sum_m += distance_m;
    filter.update(oneFeature(stamp_ns += 1000, {distance_m, 0.0}, kVariance_m2), Still());
  }
  ASSERT_EQ(filter.registry().records().size(), 1U);
  const Landmark& landmark = *filter.best().landmarks.find(0);
  EXPECT_NEAR(landmark.mean_m.x(), sum_m / 4.0, 1e-9);
  EXPECT_NEAR(landmark.covariance_m2(0, 0), kVariance_m2 / 4.0, 1e-12);
}

TEST(UpdateMaps, KeepBoundsWithinWhichALandmarkCanBeMatched) {
  const FastSlamParameters parameters = plain();
  FastSlam filter(parameters);
  filter.update(oneFeature(1000, {2.0, 0.0}, kVariance_m2), Still());
  // Square root of the gate times that of the trace, to every side.
  const double reach_m = std::sqrt(parameters.creation_gate) * std::sqrt(2.0 * kVariance_m2);
  const Eigen::AlignedBox2d bounds_m = filter.registry().records()[0].bounds_m;
  EXPECT_TRUE(bounds_m.min().isApprox(Eigen::Vector2d(2.0 - reach_m, -reach_m), 1e-9));
  EXPECT_TRUE(bounds_m.max().isApprox(Eigen::Vector2d(2.0 + reach_m, reach_m), 1e-9));
}

TEST(UpdateMaps, RememberFromWhereAMatchedLandmarkWasSeen) {
  FastSlam filter(plain());
  filter.update(oneFeature(1000, {2.0, 0.0}, kVariance_m2), Still());
  EXPECT_FALSE(knownFrom(filter.registry().records()[0], {-2.0, 0.0}));
  filter.update(oneFeature(2000, {2.0, 0.0}, kVariance_m2), Still());
  EXPECT_TRUE(knownFrom(filter.registry().records()[0], {-1.9, 0.0}));
  EXPECT_FALSE(knownFrom(filter.registry().records()[0], {1.9, 0.0}));
}

TEST(UpdateMaps, GiveALandmarkOfOtherParticlesTheSameIdentifier) {
  // Particles scattered by half a metre: a second feature is new to those that did not match it.
  PoseWithCovariance2 start;
  start.covariance.diagonal() << 0.01, 0.01, 0.0;
  FastSlamParameters parameters = plain();
  parameters.mode = FastSlamMode::kFastSlam1;
  parameters.particle_amount = 50;
  FastSlam filter(parameters, {}, start);
  for (std::int64_t i = 1; i <= 5; ++i)
    filter.update(oneFeature(1000 * i, {2.0, 0.0}, kVariance_m2), Still());
  EXPECT_EQ(filter.registry().records().size(), 1U);
}

TEST(Resample, OfParticlesThatWeighTheSameKeepsAllOfThem) {
  FastSlamParameters parameters = plain();
  parameters.particle_amount = 20;
  PoseWithCovariance2 start;
  start.covariance.diagonal() << 0.01, 0.01, 0.0;
  FastSlam filter(parameters, {}, start);
  const std::vector<Particle> before = filter.particles();
  filter.update(FeatureList{1000, {}}, Still());
  ASSERT_EQ(filter.particles().size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(filter.particles()[i].map_from_base.x_m, before[i].map_from_base.x_m);
}

}  // namespace
}  // namespace ram_slam
