// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/pose_estimate.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace ram_slam {
namespace {

std::vector<Particle> particlesAt(const std::vector<Pose2>& poses) {
  std::vector<Particle> particles(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) particles[i].proposal.pose = poses[i];
  return particles;
}

TEST(EstimatePose, IsTheWeightedMean) {
  const auto particles = particlesAt({{0.0, 1.0, 0.1}, {4.0, 2.0, 0.3}});
  const Pose2 mean = estimatePose(particles, {0.75, 0.25}).pose;
  EXPECT_NEAR(mean.x_m, 1.0, 1e-12);
  EXPECT_NEAR(mean.y_m, 1.25, 1e-12);
  EXPECT_NEAR(mean.yaw_rad, 0.15, 1e-12);
}

TEST(EstimatePose, AveragesYawAcrossTheTurnFromPiToMinusPi) {
  const auto particles = particlesAt({{0.0, 0.0, M_PI - 0.1}, {0.0, 0.0, -M_PI + 0.3}});
  EXPECT_NEAR(estimatePose(particles, {0.5, 0.5}).pose.yaw_rad, -M_PI + 0.1, 1e-12);
}

TEST(EstimatePose, HasTheUnbiasedCovarianceOfASample) {
  // Three particles of equal weight at -1, 0 and 1: their sample variance is 2 / (3 - 1).
  const auto particles = particlesAt({{-1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
  const double third = 1.0 / 3.0;
  EXPECT_NEAR(estimatePose(particles, {third, third, third}).covariance(0, 0), 1.0, 1e-12);
}

TEST(EstimatePose, AddsTheMeanOfTheParticlesOwnCovariances) {
  auto particles = particlesAt({{}, {}});
  particles[0].proposal.covariance = Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal();
  particles[1].proposal.covariance = Eigen::Vector3d(0.3, 0.2, 0.1).asDiagonal();
  const Eigen::Matrix3d wanted = Eigen::Vector3d(0.25, 0.2, 0.15).asDiagonal();
  EXPECT_TRUE(estimatePose(particles, {0.25, 0.75}).covariance.isApprox(wanted, 1e-12));
}

TEST(EstimatePose, OfOneParticleIsThatParticle) {
  auto particles = particlesAt({{1.0, 2.0, 3.0}});
  particles[0].proposal.covariance(0, 0) = 0.04;
  const PoseWithCovariance2 estimate = estimatePose(particles, {1.0});
  EXPECT_EQ(estimate.pose.x_m, 1.0);
  EXPECT_NEAR(estimate.covariance(0, 0), 0.04, 1e-15);
}

TEST(WeightsOf, AreProportionalToTheExponentialAndSumToOne) {
  std::vector<Particle> particles(2);
  particles[0].log_weight = -1000.0;  // exp() of it alone is zero
  particles[1].log_weight = -1000.0 + std::log(3.0);
  const std::vector<double> weights = weightsOf(particles);
  EXPECT_NEAR(weights[0], 0.25, 1e-12);
  EXPECT_NEAR(weights[1], 0.75, 1e-12);
}

TEST(Largest, IsTheFirstOfSeveral) {
  EXPECT_EQ(largest({0.1, 0.4, 0.4, 0.1}), 1U);
}

TEST(SamplePose, IsTheMeanWithoutCovariance) {
  const Pose2 pose = samplePose({{1.0, -2.0, 0.5}, Eigen::Matrix3d::Zero()}, Random(1));
  EXPECT_EQ(pose.x_m, 1.0);
  EXPECT_EQ(pose.y_m, -2.0);
  EXPECT_EQ(pose.yaw_rad, 0.5);
}

TEST(SamplePose, HasTheMeanAndTheCovarianceOfTheDistribution) {
  constexpr int kSamples = 20000;
  PoseWithCovariance2 from{{1.0, -2.0, 3.1}, Eigen::Matrix3d::Zero()};
  from.covariance << 0.04, 0.01, 0.0, 0.01, 0.09, 0.0, 0.0, 0.0, 0.01;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d deviation =
        componentDifference(samplePose(from, Random(1, i)), from.pose);
    mean += deviation / kSamples;
    covariance += deviation * deviation.transpose() / kSamples;
  }
  // Four standard deviations of a mean, sigma / sqrt(n), and of a variance, about sqrt(2 / n).
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 4.0 * 0.3 / std::sqrt(kSamples));
  EXPECT_LT((covariance - from.covariance).cwiseAbs().maxCoeff(),
            4.0 * 0.09 * std::sqrt(2.0 / kSamples));
}

}  // namespace
}  // namespace ram_slam
