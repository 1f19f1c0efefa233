// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/proposal.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

constexpr double kPrior_m2 = 0.04;     // of the pose along x
constexpr double kLandmark_m2 = 0.01;  // per axis
constexpr double kFeature_m2 = 0.02;   // per axis
constexpr std::int64_t kFromNs = 1000;
constexpr std::int64_t kToNs = 2000;

/// Moves every pose by 1 m along x; records what it was asked.
class FixedMotion : public MotionModel {
public:
  PoseWithCovariance2 motion(std::int64_t, std::int64_t) const override {
    return {{1.0, 0.0, 0.0}, Eigen::Matrix3d::Zero()};
  }
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t,
                            std::int64_t,
                            std::uint64_t seed) const override {
    seed_ = seed;
    std::vector<Pose2> poses;
    for (std::size_t i = 0; i + missing_ < map_from_base.size(); ++i)
      poses.push_back(map_from_base[i] * Pose2{1.0, 0.0, 0.0});
    return poses;
  }

  mutable std::uint64_t seed_ = 0;
  std::size_t missing_ = 0;
};

/// A robot that may be anywhere along x, and a landmark 3 m ahead of the origin.
Particle particleAt(const Pose2& map_from_base, double variance_m2) {
  Particle particle;
  particle.map_from_base = map_from_base;
  particle.proposal.pose = map_from_base;
  particle.proposal.covariance(0, 0) = variance_m2;
  particle.landmarks.set(0, {{3.0, 0.0}, kLandmark_m2 * Eigen::Matrix2d::Identity()});
  return particle;
}

/// The landmark is seen at that distance ahead.
std::vector<Observation> seenAt(double distance_m) {
  return {
      {"pole", {{distance_m, 0.0}, kFeature_m2 * Eigen::Matrix2d::Identity()}, {{0, true, 0.0}}}};
}

double normalDensity(double deviation, double variance) {
  return std::exp(-0.5 * deviation * deviation / variance) / std::sqrt(2.0 * M_PI * variance);
}

FastSlamParameters everythingMatches() {
  FastSlamParameters parameters;
  parameters.mode = FastSlamMode::kFastSlam1;
  parameters.feature_match_distance = parameters.minimum_feature_separation = 100.0;
  return parameters;
}

TEST(FastSlam2Proposal, IsTheKalmanPosteriorOfOneDimension) {
  const FastSlamParameters parameters;
  const Evidence evidence =
      FastSlam2Proposal(parameters)
          .associate(seenAt(2.9), particleAt({0.0, 0.0, 0.0}, kPrior_m2), Random(1));
  // The feature is 0.1 m nearer than expected, so the robot is farther ahead.
  const double innovation_m2 = kPrior_m2 + kLandmark_m2 + kFeature_m2;
  const double gain = kPrior_m2 / innovation_m2;
  EXPECT_NEAR(evidence.map_from_base.pose.x_m, gain * 0.1, 1e-12);
  EXPECT_NEAR(evidence.map_from_base.covariance(0, 0), (1.0 - gain) * kPrior_m2, 1e-12);
  EXPECT_NEAR(evidence.squared_mahalanobis, 0.01 / innovation_m2, 1e-12);
  const double density = normalDensity(0.1, innovation_m2) *
                         normalDensity(0.0, kLandmark_m2 + kFeature_m2) /
                         parameters.unknown_feature_density;
  EXPECT_NEAR(evidence.log_likelihood_ratio, std::log(density), 1e-12);
}

TEST(FastSlam1Proposal, WeighsASampledPoseAndLeavesItWhereItIs) {
  const FastSlamParameters parameters = everythingMatches();
  const Evidence evidence =
      FastSlam1Proposal(parameters)
          .associate(seenAt(2.9), particleAt({0.03, 0.0, 0.0}, 0.0), Random(1));
  EXPECT_EQ(evidence.map_from_base.pose.x_m, 0.03);
  EXPECT_TRUE(evidence.map_from_base.covariance.isZero(0.0));
  const double variance_m2 = kLandmark_m2 + kFeature_m2;
  const double density = normalDensity(0.07, variance_m2) * normalDensity(0.0, variance_m2) /
                         parameters.unknown_feature_density;
  EXPECT_NEAR(evidence.log_likelihood_ratio, std::log(density), 1e-12);
}

TEST(Proposals, GiveTheSameEvidenceOnceTheSampledPosesAreAveraged) {
  // p(z) = integral of p(z | x) p(x) dx: the mean weight of version 1.0 is the weight of 2.0.
  constexpr double kStep_m = 0.01;
  const FastSlam1Proposal first(everythingMatches());
  double mean_weight = 0.0;
  for (double x_m = -2.0; x_m < 2.0; x_m += kStep_m) {
    const Evidence evidence =
        first.associate(seenAt(2.8), particleAt({x_m, 0.0, 0.0}, 0.0), Random(1));
    mean_weight +=
        kStep_m * normalDensity(x_m, kPrior_m2) * std::exp(evidence.log_likelihood_ratio);
  }
  const Evidence evidence =
      FastSlam2Proposal(FastSlamParameters{})
          .associate(seenAt(2.8), particleAt({0.0, 0.0, 0.0}, kPrior_m2), Random(1));
  EXPECT_NEAR(std::log(mean_weight), evidence.log_likelihood_ratio, 1e-9);
}

TEST(FastSlam2Proposal, PredictsTheMotionSinceTheLastUpdateWithItsCovariance) {
  PoseWithCovariance2 since_update{{1.0, 0.0, 0.1}, Eigen::Matrix3d::Zero()};
  since_update.covariance.diagonal() << 0.04, 0.01, 0.001;
  const std::vector<Particle> particles = {particleAt({2.0, 1.0, M_PI_2}, 0.0)};
  const auto predicted =
      FastSlam2Proposal(FastSlamParameters{}).predict(particles, {}, since_update, 1);
  ASSERT_EQ(predicted.size(), 1U);
  EXPECT_NEAR(predicted[0].pose.x_m, 2.0, 1e-12);
  EXPECT_NEAR(predicted[0].pose.y_m, 2.0, 1e-12);
  EXPECT_NEAR(predicted[0].pose.yaw_rad, M_PI_2 + 0.1, 1e-12);
  EXPECT_NEAR(predicted[0].covariance(0, 0), 0.01, 1e-12);  // turned by 90 degrees
  EXPECT_NEAR(predicted[0].covariance(1, 1), 0.04, 1e-12);
}

TEST(FastSlam1Proposal, PredictsBySamplesOfTheModelWithoutCovariance) {
  const FixedMotion model;
  const std::vector<Particle> particles = {particleAt({}, 0.0), particleAt({0.0, 2.0, 0.0}, 0.0)};
  const FastSlam1Proposal proposal(everythingMatches());
  const auto predicted = proposal.predict(particles, {kFromNs, kToNs, {}, &model}, {}, 77);
  ASSERT_EQ(predicted.size(), 2U);
  EXPECT_EQ(model.seed_, 77U);
  EXPECT_EQ(predicted[1].pose.x_m, 1.0);
  EXPECT_EQ(predicted[1].pose.y_m, 2.0);
  EXPECT_TRUE(predicted[1].covariance.isZero(0.0));
}

TEST(FastSlam1Proposal, DoesNotAskTheModelBeforeTheFirstListNorForNoTime) {
  const FixedMotion model;
  const std::vector<Particle> particles = {particleAt({}, 0.0)};
  const FastSlam1Proposal proposal(everythingMatches());
  EXPECT_EQ(proposal.predict(particles, {0, kToNs, {}, &model}, {}, 77)[0].pose.x_m, 0.0);
  EXPECT_EQ(proposal.predict(particles, {kToNs, kToNs, {}, &model}, {}, 77)[0].pose.x_m, 0.0);
  EXPECT_EQ(model.seed_, 0U);
}

TEST(FastSlam1Proposal, RefusesAModelThatGivesTooFewPoses) {
  FixedMotion model;
  model.missing_ = 1;
  const std::vector<Particle> particles = {particleAt({}, 0.0), particleAt({}, 0.0)};
  EXPECT_THROW(FastSlam1Proposal(everythingMatches())
                   .predict(particles, {kFromNs, kToNs, {}, &model}, {}, 1),
               std::invalid_argument);
}

TEST(Proposals, FollowFromTheModeAndDifferInWhenTheyUpdateAndResample) {
  FastSlamParameters parameters;
  parameters.resample_threshold = 0.5;
  parameters.update_distance = 0.1;
  parameters.update_angle = 0.2;
  FeatureList list;
  list.features.resize(1);
  const auto second = makeProposal(parameters);
  EXPECT_TRUE(second->coversSharedErrors());
  EXPECT_TRUE(second->isResamplingDue(49.0, 100));
  EXPECT_FALSE(second->isResamplingDue(50.0, 100));
  EXPECT_FALSE(second->isUpdateDue(list, {0.09, 0.0, -0.19}, false));
  EXPECT_TRUE(second->isUpdateDue(list, {0.06, 0.08, 0.0}, false));
  EXPECT_TRUE(second->isUpdateDue(list, {0.0, 0.0, -0.2}, false));
  EXPECT_TRUE(second->isUpdateDue(list, {}, true));
  EXPECT_FALSE(second->isUpdateDue({}, {1.0, 0.0, 0.0}, true)) << "without features";
  parameters.mode = FastSlamMode::kFastSlam1;
  const auto first = makeProposal(parameters);
  EXPECT_FALSE(first->coversSharedErrors());
  EXPECT_TRUE(first->isResamplingDue(100.0, 100));
  EXPECT_TRUE(first->isUpdateDue({}, {}, false));
}

}  // namespace
}  // namespace ram_slam
