// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/association_candidates.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

/// One particle at the origin that knows its pose, a landmark 2 m ahead, and a feature there.
class AssociationCandidatesTest : public testing::Test {
protected:
  AssociationCandidatesTest() {
    parameters_.creation_gate = 25.0;
    parameters_.feature_noise_floor = 0.03;
    particles_.resize(1);
    list_.features = {featureAt(2.0)};
    addLandmark(2.0, "pole");
  }

  static Feature featureAt(double x_m) {
    Feature feature;
    feature.type = "pole";
    feature.position_m = {x_m, 0.0};
    feature.covariance_m2 = 0.0016 * Eigen::Matrix2d::Identity();
    return feature;
  }

  LandmarkRecord& addLandmark(double x_m, const std::string& type) {
    Feature feature = featureAt(x_m);
    feature.type = type;
    LandmarkRecord& record = registry_.create(feature, nullptr);
    record.bounds_m.extend(feature.position_m);
    return record;
  }

  std::vector<Observation> observe() const {
    return AssociationCandidates(parameters_, {}, registry_, particles_, 0)
        .observe(list_, std::vector<DescriptorPointer>(list_.features.size()));
  }

  std::vector<LandmarkId> candidates() const {
    const std::vector<Observation> observations = observe();
    std::vector<LandmarkId> ids;
    for (const AssociationCandidate& candidate : observations[0].candidates)
      ids.push_back(candidate.id);
    return ids;
  }

  FastSlamParameters parameters_;
  LandmarkRegistry registry_;
  std::vector<Particle> particles_;
  FeatureList list_;
};

TEST_F(AssociationCandidatesTest, AddTheNoiseFloorToTheCovarianceOfTheFeature) {
  const PointMeasurement measured = observe()[0].measured;
  EXPECT_EQ(measured.position_m, Eigen::Vector2d(2.0, 0.0));
  const Eigen::Matrix2d wanted = (0.0016 + 0.0009) * Eigen::Matrix2d::Identity();
  EXPECT_TRUE(measured.covariance_m2.isApprox(wanted, 1e-12));
}

TEST_F(AssociationCandidatesTest, HaveTheTypeOfTheFeature) {
  addLandmark(2.0, "corner");
  EXPECT_THAT(candidates(), testing::ElementsAre(0));
}

TEST_F(AssociationCandidatesTest, AreWithinTheCreationGateOfTheFeaturesNoise) {
  // Square root of the gate times that of the trace: 5 * sqrt(2 * 0.05^2) = 0.354 m.
  addLandmark(2.35, "pole");
  addLandmark(2.36, "pole");
  EXPECT_THAT(candidates(), testing::ElementsAre(0, 1));
}

TEST_F(AssociationCandidatesTest, AreFartherAwayIfThePoseIsUncertain) {
  addLandmark(4.0, "pole");
  EXPECT_THAT(candidates(), testing::ElementsAre(0));
  particles_[0].proposal.covariance(2, 2) = 0.02;  // 0.14 rad at 2 m: 5 * sqrt(2 * 0.08) = 2 m
  EXPECT_THAT(candidates(), testing::ElementsAre(0, 1));
}

TEST_F(AssociationCandidatesTest, AreNearTheFeatureInSomeParticle) {
  addLandmark(7.0, "pole");
  particles_.resize(2);
  particles_[1].proposal.pose = {5.0, 0.0, 0.0};
  EXPECT_THAT(candidates(), testing::ElementsAre(0, 1));
}

TEST_F(AssociationCandidatesTest, AreConfirmedFromTheLogOddsOfTheParameterOn) {
  registry_.find(0)->existence_log_odds = parameters_.confirm_log_odds - 0.01;
  EXPECT_FALSE(observe()[0].candidates[0].confirmed);
  registry_.find(0)->existence_log_odds = parameters_.confirm_log_odds;
  EXPECT_TRUE(observe()[0].candidates[0].confirmed);
}

TEST_F(AssociationCandidatesTest, CarryNoEvidenceWithoutAppearanceAndOrientation) {
  EXPECT_EQ(observe()[0].candidates[0].log_likelihood_ratio, 0.0);
}

TEST_F(AssociationCandidatesTest, WeighTheOrientationSeenFromTheBestParticle) {
  particles_[0].proposal.pose.yaw_rad = 0.4;
  particles_[0].proposal.covariance(2, 2) = 0.0004;
  list_.features[0].orientation_rad = 0.5;
  list_.features[0].orientation_variance_rad2 = 0.0009;
  LandmarkRecord& record = *registry_.find(0);
  record.orientation_rad = 0.8;
  record.orientation_variance_rad2 = 0.0016;
  record.bounds_m.extend(particles_[0].proposal.pose * list_.features[0].position_m);
  parameters_.appearance.orientation_sigma_rad = 0.05;
  const double wanted = orientationLogRatio(0.1, 0.0004 + 0.0009 + 0.0016 + 0.0025,
                                            parameters_.appearance.wrong_orientation_share);
  EXPECT_NEAR(observe()[0].candidates[0].log_likelihood_ratio, wanted, 1e-9);
}

}  // namespace
}  // namespace ram_slam
