// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_records.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace ram_slam {
namespace {

LandmarkEstimate pole(LandmarkId id, double x_m) {
  LandmarkEstimate estimate;
  estimate.id = id;
  estimate.type = "pole";
  estimate.mean_m = {x_m, 0.0};
  estimate.covariance_m2 = 0.01 * Eigen::Matrix2d::Identity();
  estimate.existence_log_odds = 100.0;
  return estimate;
}

/// A registry and a particle that hold these poles.
struct Poles {
  LandmarkRegistry registry;
  std::vector<Particle> particles = std::vector<Particle>(1);

  explicit Poles(const std::vector<double>& xs_m) {
    for (const double x_m : xs_m) {
      const LandmarkEstimate estimate =
          pole(static_cast<LandmarkId>(registry.records().size()), x_m);
      registry.restore(recordOf(estimate, {}, {}));
      particles[0].landmarks.set(estimate.id, {estimate.mean_m, estimate.covariance_m2});
    }
    for (LandmarkRecord& record : registry.records()) refreshBounds(record, particles, 25.0);
  }
};

TEST(LandmarkRecords, RefuseCovariancesThatAreNone) {
  Feature feature;
  EXPECT_NO_THROW(requireGood(feature));
  feature.covariance_m2(0, 1) = 2.0;
  EXPECT_THROW(requireGood(feature), std::invalid_argument);
  PoseWithCovariance2 pose;
  EXPECT_NO_THROW(requireGood(pose)) << "a pose may be certain";
  pose.covariance(2, 2) = -1.0;
  EXPECT_THROW(requireGood(pose), std::invalid_argument);
}

TEST(LandmarkRecords, RefuseAListFromBeforeTheLastOne) {
  FeatureList list;
  list.stamp_ns = 5;
  EXPECT_NO_THROW(requireGood(list, 5));
  EXPECT_THROW(requireGood(list, 6), std::invalid_argument);
}

TEST(LandmarkRecords, AreAsCertainAsTheFilterAllows) {
  const FastSlamParameters parameters;
  const LandmarkRecord record = recordOf(pole(7, 1.0), {}, parameters);
  EXPECT_EQ(record.id, 7u);
  EXPECT_EQ(record.existence_log_odds, parameters.maximum_log_odds);
  EXPECT_TRUE(record.was_confirmed);
}

TEST(LandmarkRecords, EncloseWhereALandmarkCanBeMatched) {
  const Poles poles({3.0});
  const Eigen::AlignedBox2d& bounds_m = poles.registry.records()[0].bounds_m;
  EXPECT_NEAR(bounds_m.sizes().x(), 2.0 * 5.0 * std::sqrt(0.02), 1e-12);
  EXPECT_NEAR(bounds_m.center().x(), 3.0, 1e-12);
}

TEST(LandmarkRecords, OfOneThingAreFoundTheYoungerIsTheDuplicate) {
  const Poles poles({0.0, 5.0, 0.1});
  const auto sum = [](LandmarkId, LandmarkId) {
    return Eigen::Matrix2d(0.02 * Eigen::Matrix2d::Identity());
  };
  EXPECT_EQ(duplicates(poles.registry, poles.particles[0].landmarks, sum, {}, {}),
            std::vector<LandmarkId>{2});
  const auto exact = [](LandmarkId, LandmarkId) {
    return Eigen::Matrix2d(1e-9 * Eigen::Matrix2d::Identity());
  };
  FastSlamParameters parameters;
  parameters.feature_noise_floor = 0.0;
  EXPECT_TRUE(
      duplicates(poles.registry, poles.particles[0].landmarks, exact, {}, parameters).empty());
}

}  // namespace
}  // namespace ram_slam
