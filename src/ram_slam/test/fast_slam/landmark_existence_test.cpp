// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_existence.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

/// Shows the same of every point; empty only behind a wall at that distance to the left.
class UniformView : public FieldOfView {
public:
  explicit UniformView(Sight sight) : sight_(sight) {}
  Sight look(const Eigen::Vector2d& point_in_base_m) const override {
    return point_in_base_m.y() > empty_up_to_m_ ? Sight::kHidden : sight_;
  }
  double range_m() const override { return 10.0; }
  bool showsEverySide() const override { return shows_every_side_; }

  double empty_up_to_m_ = 100.0;
  bool shows_every_side_ = true;

private:
  Sight sight_;
};

/// Two particles at the origin that hold the same landmark 2 m ahead.
class LandmarkExistenceTest : public testing::Test {
protected:
  LandmarkExistenceTest() {
    LandmarkRecord& record = registry_.create(Feature{}, nullptr);
    record.bounds_m.extend(Eigen::Vector2d(2.0, 0.0));
    particles_.resize(2);
    for (Particle& particle : particles_)
      particle.landmarks.set(0, {{2.0, 0.0}, 0.01 * Eigen::Matrix2d::Identity()});
  }

  std::vector<LandmarkId> update(const FieldOfView* view) {
    return LandmarkExistence(parameters_, particles_, {0.5, 0.5}).update(registry_, view, {});
  }
  LandmarkRecord& landmark() { return *registry_.find(0); }
  double logOdds() { return landmark().existence_log_odds; }

  FastSlamParameters parameters_;  // found with 0.5, by mistake with 0.05
  LandmarkRegistry registry_;
  std::vector<Particle> particles_;
  const double found_ = std::log(0.5 / 0.05);
  const double missed_ = std::log((1.0 - 0.5) / (1.0 - 0.05));
};

TEST_F(LandmarkExistenceTest, GrowsByTheRatioOfTheDetectionProbabilities) {
  landmark().matched_weight = 1.0;
  EXPECT_THAT(update(nullptr), testing::IsEmpty());
  EXPECT_NEAR(logOdds(), found_, 1e-12);
  EXPECT_EQ(landmark().matched_weight, 0.0) << "cleared for the next reading";
  EXPECT_TRUE(landmark().was_confirmed);
}

TEST_F(LandmarkExistenceTest, StaysWithinTheMaximum) {
  for (int i = 0; i < 10; ++i) {
    landmark().matched_weight = 1.0;
    update(nullptr);
  }
  EXPECT_EQ(logOdds(), parameters_.maximum_log_odds);
}

TEST_F(LandmarkExistenceTest, FallsByTheRatioOfMissingItWhereTheViewShowsSomething) {
  const UniformView view(Sight::kVisible);
  update(&view);
  EXPECT_NEAR(logOdds(), missed_, 1e-12);
}

TEST_F(LandmarkExistenceTest, IsTheMixtureIfOnlySomeParticlesFoundIt) {
  const UniformView view(Sight::kVisible);
  landmark().matched_weight = 0.75;
  update(&view);
  EXPECT_NEAR(logOdds(), 0.75 * found_ + 0.25 * missed_, 1e-12);
}

TEST_F(LandmarkExistenceTest, DoesNotChangeWithoutAViewOrWhereItIsHidden) {
  const UniformView hidden(Sight::kHidden);
  update(nullptr);
  update(&hidden);
  EXPECT_EQ(logOdds(), 0.0);
}

TEST_F(LandmarkExistenceTest, DoesNotChangeBeyondTheRangeOfTheView) {
  const UniformView view(Sight::kVisible);
  landmark().bounds_m = Eigen::AlignedBox2d(Eigen::Vector2d(10.1, 0.0));
  update(&view);
  EXPECT_EQ(logOdds(), 0.0);
}

TEST_F(LandmarkExistenceTest, IsRefutedByViewsThroughItsPlace) {
  const UniformView view(Sight::kEmpty);
  EXPECT_THAT(update(&view), testing::IsEmpty());
  EXPECT_NEAR(logOdds(), parameters_.existence.passed_log_odds, 1e-12);
  EXPECT_THAT(update(&view), testing::ElementsAre(0)) << "-4 is below delete_log_odds = -2";
}

TEST_F(LandmarkExistenceTest, IsNotRefutedAtTheEdgeOfWhatIsEmpty) {
  UniformView view(Sight::kEmpty);
  view.empty_up_to_m_ = 0.5 * parameters_.existence.edge_margin_m;
  update(&view);
  EXPECT_EQ(logOdds(), 0.0);
}

TEST_F(LandmarkExistenceTest, OfAConfirmedLandmarkFallsNoLowerThanTheBoundIfItIsOnlyOverlooked) {
  const UniformView visible(Sight::kVisible);
  const UniformView empty(Sight::kEmpty);
  landmark().existence_log_odds = 2.0;
  landmark().was_confirmed = true;
  for (int i = 0; i < 20; ++i) EXPECT_THAT(update(&visible), testing::IsEmpty());
  EXPECT_EQ(logOdds(), parameters_.existence.overlooked_log_odds);
  update(&empty);
  EXPECT_LT(logOdds(), parameters_.existence.overlooked_log_odds);
}

TEST_F(LandmarkExistenceTest, OfAThingWithSidesIsMissedOnlyFromWhereItWasSeen) {
  UniformView view(Sight::kVisible);
  view.shows_every_side_ = false;
  landmark().seen_within_m = 5.0;
  update(&view);
  EXPECT_EQ(logOdds(), 0.0) << "never seen from this side";
  addSighting(landmark(), {-3.0, 0.0}, nullptr, nullptr, {});
  update(&view);
  EXPECT_NEAR(logOdds(), missed_, 1e-12);
}

TEST_F(LandmarkExistenceTest, IsJudgedByTheParticlesThatHoldIt) {
  const UniformView view(Sight::kVisible);
  particles_[1].landmarks.erase(0);
  update(&view);
  EXPECT_NEAR(logOdds(), missed_, 1e-12);
}

}  // namespace
}  // namespace ram_slam
