// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/fast_slam.hpp"

#include "fast_slam_fixtures.hpp"

namespace ram_slam {
namespace {

TEST(FastSlam, TourOfTwoRoundsStaysNearTheTruthAndFindsItsLandmarksAgain) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SyntheticDrive drive = office(seed);
    const FastSlam filter = run(drive, {});
    const Errors errors = errorsOf(filter.trajectory(), drive.truth);
    EXPECT_LT(errors.position_m, 0.1);
    EXPECT_LT(errors.yaw_rad, 0.02);
    EXPECT_NEAR(static_cast<double>(filter.landmarks().landmarks.size()),
                static_cast<double>(drive.landmarks_m.size()), 3.0);
  }
}

TEST(FastSlam, WithoutFeaturesAndNoiseTheTrajectoryIsTheOdometry) {
  SyntheticNoise none;
  none.drive_m2_per_m = none.side_m2_per_m = none.turn_rad2_per_m = none.turn_rad2_per_rad = 0.0;
  FastSlamParameters parameters;
  parameters.particle_amount = 1;
  const SyntheticDrive drive = syntheticDrive(rectangleTour(4.0, 3.0, 1), {}, 6.0, none, 1);
  const FastSlam filter = run(drive, parameters);
  EXPECT_EQ(filter.trajectory().size(), drive.truth.size());
  const Errors errors = errorsOf(filter.trajectory(), drive.truth);
  EXPECT_LT(errors.position_m, 1e-12);
  EXPECT_LT(errors.yaw_rad, 1e-12);
}

TEST(FastSlam, AtRestNoParticlesPathGrows) {
  FastSlam filter(FastSlamParameters{});
  SyntheticOdometry odometry;
  Random random(5);
  for (int i = 1; i <= 300; ++i) {
    odometry.add(i, {}, {}, random);
    filter.update(oneFeature(i, {2.0, 1.0}, 4e-4), odometry);
  }
  for (const Particle& particle : filter.particles()) EXPECT_LE(particle.path.size(), 2U);
  EXPECT_EQ(filter.trajectory().back().stamp_ns, 300);
}

TEST(FastSlam, FromAKnownPoseALandmarksCovarianceFallsWithTheNumberOfObservations) {
  constexpr double kVariance_m2 = 4e-4;
  constexpr int kObservations = 20;
  FastSlamParameters parameters = plain();
  parameters.particle_amount = 1;
  FastSlam filter(parameters);
  SyntheticOdometry odometry;
  Random random(5);
  for (int i = 1; i <= kObservations; ++i) {
    odometry.add(i, {}, {}, random);
    filter.update(oneFeature(i, {2.0, 1.0}, kVariance_m2), odometry);
  }
  const Landmark* landmark = filter.best().landmarks.find(0);
  ASSERT_NE(landmark, nullptr);
  EXPECT_NEAR(
      (landmark->covariance_m2 - kVariance_m2 / kObservations * Eigen::Matrix2d::Identity()).norm(),
      0.0, 1e-12);
  EXPECT_NEAR((landmark->mean_m - Eigen::Vector2d(2.0, 1.0)).norm(), 0.0, 1e-12);
}

/// Robot on a line that drives 0.5 m per step (variance 0.04 m^2) and measures where two
/// known-by-type landmarks are (variance 0.0025 m^2): linear and Gaussian, so that a Kalman filter
/// over pose and landmarks is exact.
class LineWorld : public MotionModel {
public:
  static constexpr double kMotionVariance_m2 = 0.04;
  static constexpr double kFeatureVariance_m2 = 0.0025;
  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    const double steps = static_cast<double>(to_ns - from_ns);
    PoseWithCovariance2 motion;
    motion.pose.x_m = 0.5 * steps;
    motion.covariance(0, 0) = kMotionVariance_m2 * steps;
    return motion;
  }
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t from_ns,
                            std::int64_t to_ns,
                            std::uint64_t seed) const override {
    std::vector<Pose2> poses = map_from_base;
    const PoseWithCovariance2 mean = motion(from_ns, to_ns);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i].x_m += mean.pose.x_m + std::sqrt(mean.covariance(0, 0)) * Random(seed, i).gaussian();
    }
    return poses;
  }
};

/// Mean over runs of filter variance / exact variance and of (mean - exact mean)^2 / exact
/// variance.
struct Agreement {
  double variance_ratio = 0.0;
  double squared_distance = 0.0;
};

Agreement compareWithKalman(FastSlamMode mode, int particles) {
  constexpr int kRuns = 200;
  constexpr int kSteps = 12;
  const std::vector<double> landmarks_m = {3.0, 5.0};
  FastSlamParameters parameters = plain();
  parameters.mode = mode;
  parameters.particle_amount = particles;
  parameters.association_gate = parameters.creation_gate = 1e6;
  parameters.unknown_feature_density = 1e-300;
  parameters.feature_match_distance = parameters.minimum_feature_separation = 100.0;
  const LineWorld world;
  Agreement agreement;
  for (int run = 0; run < kRuns; ++run) {
    Random random(100 + run);
    parameters.seed = run;
    FastSlam filter(parameters);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // pose, landmarks
    Eigen::Matrix3d covariance = Eigen::Vector3d(0.0, 1e8, 1e8).asDiagonal();
    double truth_m = 0.0;
    for (int step = 1; step <= kSteps; ++step) {
      FeatureList list;
      list.stamp_ns = step;
      if (step > 1) {
        truth_m += 0.5 + std::sqrt(LineWorld::kMotionVariance_m2) * random.gaussian();
        mean[0] += 0.5;
        covariance(0, 0) += LineWorld::kMotionVariance_m2;
      }
      for (int i = 0; i < 2; ++i) {
        const double z_m = landmarks_m[i] - truth_m +
                           std::sqrt(LineWorld::kFeatureVariance_m2) * random.gaussian();
        Feature feature = oneFeature(step, {z_m, 0.0}, LineWorld::kFeatureVariance_m2).features[0];
        feature.type = std::to_string(i);
        list.features.push_back(feature);
        Eigen::RowVector3d h = Eigen::RowVector3d::Zero();
        h[0] = -1.0;
        h[1 + i] = 1.0;
        const double s = h * covariance * h.transpose() + LineWorld::kFeatureVariance_m2;
        const Eigen::Vector3d gain = covariance * h.transpose() / s;
        mean += gain * (z_m - h * mean);
        covariance -= gain * s * gain.transpose();
      }
      filter.update(list, world);
    }
    const double exact = covariance(0, 0);
    agreement.variance_ratio += filter.estimate().covariance(0, 0) / exact / kRuns;
    const double error_m = filter.estimate().pose.x_m - mean[0];
    agreement.squared_distance += error_m * error_m / exact / kRuns;
  }
  return agreement;
}

TEST(FastSlam, Version2AgreesWithTheKalmanFilterWhereThatIsExact) {
  const Agreement agreement = compareWithKalman(FastSlamMode::kFastSlam2, 50);
  EXPECT_GT(agreement.variance_ratio, 0.95);
  EXPECT_LT(agreement.variance_ratio, 1.1);
  EXPECT_LT(agreement.squared_distance, 0.1);
}

TEST(FastSlam, Version1ShowsItsKnownWeaknessThere) {
  const Agreement agreement = compareWithKalman(FastSlamMode::kFastSlam1, 50);
  EXPECT_LT(agreement.variance_ratio, 0.9);
  EXPECT_GT(agreement.squared_distance, 0.2);
}

}  // namespace
}  // namespace ram_slam
