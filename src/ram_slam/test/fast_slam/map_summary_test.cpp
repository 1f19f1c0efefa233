// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/map_summary.hpp"

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

/// Two particles, of weight 0.75 and 0.25.
class MapSummaryTest : public testing::Test {
protected:
  MapSummaryTest() : particles_(2) {}

  /// A landmark that both particles hold, with a covariance of 0.01 and 0.02 m^2 per axis.
  LandmarkId add(const Eigen::Vector2d& first_m, const Eigen::Vector2d& second_m) {
    Feature feature;
    feature.type = "pole";
    const LandmarkId id = registry_.create(feature, nullptr).id;
    particles_[0].landmarks.set(id, {first_m, 0.01 * Eigen::Matrix2d::Identity()});
    particles_[1].landmarks.set(id, {second_m, 0.02 * Eigen::Matrix2d::Identity()});
    return id;
  }

  LandmarkMap map() const {
    return summarise(registry_, particles_[0], particles_, {0.75, 0.25}, parameters_);
  }

  LandmarkRegistry registry_;
  std::vector<Particle> particles_;
  MapSummaryParameters parameters_;
};

TEST_F(MapSummaryTest, AveragesALandmarkByTheLawOfTotalCovariance) {
  add({1.0, 0.0}, {1.4, 0.0});
  registry_.find(0)->placed_ns = 17;
  registry_.find(0)->existence_log_odds = 3.0;
  const LandmarkEstimate landmark = map().landmarks.at(0);
  EXPECT_EQ(landmark.type, "pole");
  EXPECT_EQ(landmark.placed_ns, 17);
  EXPECT_EQ(landmark.existence_log_odds, 3.0);
  EXPECT_TRUE(landmark.mean_m.isApprox(Eigen::Vector2d(1.1, 0.0), 1e-12));
  // Within: 0.75 * 0.01 + 0.25 * 0.02; between, along x: 0.75 * 0.1^2 + 0.25 * 0.3^2.
  const Eigen::Matrix2d wanted = Eigen::Vector2d(0.0125 + 0.03, 0.0125).asDiagonal();
  EXPECT_TRUE(landmark.covariance_m2.isApprox(wanted, 1e-12));
}

TEST_F(MapSummaryTest, AveragesOverTheParticlesThatHoldTheLandmark) {
  add({1.0, 0.0}, {1.4, 0.0});
  particles_[1].landmarks.erase(0);
  const LandmarkEstimate landmark = map().landmarks.at(0);
  EXPECT_TRUE(landmark.mean_m.isApprox(Eigen::Vector2d(1.0, 0.0), 1e-12));
  EXPECT_TRUE(landmark.covariance_m2.isApprox(0.01 * Eigen::Matrix2d::Identity(), 1e-12));
}

TEST_F(MapSummaryTest, HoldsTheLandmarksOfTheChosenParticle) {
  add({1.0, 0.0}, {1.0, 0.0});
  add({2.0, 0.0}, {2.0, 0.0});
  particles_[0].landmarks.erase(0);
  const LandmarkMap result = map();
  ASSERT_EQ(result.landmarks.size(), 1U);
  EXPECT_EQ(result.landmarks[0].id, 1U);
}

TEST_F(MapSummaryTest, LeavesOutWhatWasConfirmedAndOftenOverlookedSince) {
  add({1.0, 0.0}, {1.0, 0.0});
  EXPECT_EQ(map().landmarks.size(), 1U) << "never confirmed: still new";
  registry_.find(0)->was_confirmed = true;
  EXPECT_THAT(map().landmarks, testing::IsEmpty());
  registry_.find(0)->existence_log_odds = 0.1;
  EXPECT_EQ(map().landmarks.size(), 1U);
}

TEST_F(MapSummaryTest, StatesTheCovarianceBetweenLandmarksThatDeviateTogether) {
  const LandmarkId a = add({1.0, 0.0}, {1.4, 0.0});
  const LandmarkId b = add({2.0, 0.0}, {2.4, 0.0});
  const LandmarkMap result = map();
  ASSERT_EQ(result.covariances.size(), 1U);
  EXPECT_EQ(result.covariances[0].first_id, a);
  EXPECT_EQ(result.covariances[0].second_id, b);
  const Eigen::Matrix2d wanted = Eigen::Vector2d(0.03, 0.0).asDiagonal();
  EXPECT_TRUE(result.covariances[0].covariance_m2.isApprox(wanted, 1e-12));
}

TEST_F(MapSummaryTest, StatesNoCovarianceOfPairsThatAreFarApartOrHardlyCorrelated) {
  add({1.0, 0.0}, {1.4, 0.0});
  add({7.0, 0.0}, {7.4, 0.0});  // 6 m away
  add({1.0, 1.0}, {1.0, 1.0});  // the same in both particles
  EXPECT_THAT(map().covariances, testing::IsEmpty());
  parameters_.pair_distance_m = 6.1;
  EXPECT_EQ(map().covariances.size(), 1U);
}

}  // namespace
}  // namespace ram_slam
