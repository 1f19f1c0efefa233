// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <gmock/gmock.h>

#include "../fast_slam/synthetic_world.hpp"

namespace ram_slam {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kRange_m = 4.0;

/// Ten groups of three landmarks, 0.25 m from the next, around a tour.
std::vector<Eigen::Vector2d> groups() {
  std::vector<Eigen::Vector2d> landmarks_m;
  for (const Eigen::Vector2d& place_m : scatteredLandmarks({-2.0, -2.0}, {8.0, 6.0}, 10, 1.5, 3)) {
    landmarks_m.push_back(place_m);
    landmarks_m.push_back(place_m + Eigen::Vector2d(0.25, 0.0));
    landmarks_m.push_back(place_m + Eigen::Vector2d(0.0, 0.25));
  }
  return landmarks_m;
}

/// Two rounds; the robot drifts by some decimetres per round.
SyntheticDrive drive(const SyntheticNoise& noise) {
  return syntheticDrive(rectangleTour(4.0, 2.0, 2), groups(), kRange_m, noise, 1);
}

SyntheticNoise cameraNoise() {
  SyntheticNoise noise;
  noise.feature_m = 0.08;
  return noise;
}

/// The odometry alone.
Trajectory deadReckoning(const SyntheticDrive& drive) {
  Trajectory trajectory{{drive.lists.front().stamp_ns, drive.truth.front()}};
  for (std::size_t i = 1; i < drive.lists.size(); ++i) {
    const Pose2 moved =
        drive.odometry.motion(drive.lists[i - 1].stamp_ns, drive.lists[i].stamp_ns).pose;
    trajectory.push_back({drive.lists[i].stamp_ns, trajectory.back().pose * moved});
  }
  return trajectory;
}

std::vector<FeatureStep> steps(const std::vector<FeatureList>& lists, const MotionModel& odometry) {
  std::vector<FeatureStep> steps;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    steps.push_back({lists[i], {}});
    if (i > 0) steps[i].motion = odometry.motion(lists[i - 1].stamp_ns, lists[i].stamp_ns);
  }
  return steps;
}

std::vector<FeatureStep> steps(const SyntheticDrive& drive) {
  return steps(drive.lists, drive.odometry);
}

/// The true landmarks, each shifted by an error of this standard deviation.
std::vector<LandmarkEstimate> roughMap(const SyntheticDrive& drive, double deviation_m) {
  Random random(7);
  std::vector<LandmarkEstimate> landmarks;
  for (const Eigen::Vector2d& place_m : drive.landmarks_m) {
    LandmarkEstimate landmark;
    landmark.id = static_cast<LandmarkId>(landmarks.size());
    landmark.type = "pole";
    landmark.mean_m = place_m + deviation_m * Eigen::Vector2d(random.gaussian(), random.gaussian());
    landmarks.push_back(landmark);
  }
  return landmarks;
}

double rmse(const Trajectory& trajectory, const SyntheticDrive& drive) {
  double sum = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i)
    sum += (trajectory[i].pose.translation() - drive.truth[i].translation()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(trajectory.size()));
}

/// The largest distance of a true landmark to the nearest found one.
double worstMiss(const LandmarkMap& map, const SyntheticDrive& drive) {
  double worst = 0.0;
  for (const Eigen::Vector2d& place_m : drive.landmarks_m) {
    double nearest = 1e9;
    for (const LandmarkEstimate& landmark : map.landmarks)
      nearest = std::min(nearest, (landmark.mean_m - place_m).norm());
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(LandmarkSmoother, FindsTheTruthFromExactReadings) {
  SyntheticDrive exact = drive({0.0, 0.0, 0.0, 0.0, 1e-9});
  for (FeatureList& list : exact.lists) {
    for (Feature& feature : list.features)
      feature.covariance_m2 = 0.0025 * Eigen::Matrix2d::Identity();
  }
  Trajectory start = deadReckoning(exact);
  for (std::size_t i = 0; i < start.size(); ++i)
    start[i].pose.x_m += 0.3 * static_cast<double>(i) / static_cast<double>(start.size());
  const SmoothedLandmarks smoothed =
      smoothLandmarks(steps(exact), start, roughMap(exact, 0.05), {});
  EXPECT_LT(rmse(smoothed.trajectory, exact), 1e-4);
  EXPECT_EQ(smoothed.map.landmarks.size(), exact.landmarks_m.size());
  EXPECT_LT(worstMiss(smoothed.map, exact), 1e-4);
}

TEST(LandmarkSmoother, AveragesByInformation) {
  // A robot at rest sees one landmark twice: the mean of both readings, weighted by 1 / variance.
  SyntheticOdometry odometry;
  Random random(1);
  std::vector<FeatureList> lists(2);
  for (int i = 0; i < 2; ++i) {
    odometry.add(i + 1, {}, {0.0, 0.0, 0.0, 0.0, 0.0}, random);
    lists[i].stamp_ns = i + 1;
    lists[i].features.resize(1);
    lists[i].features[0].type = "pole";
  }
  lists[0].features[0].position_m = {20.0, 0.0};
  lists[0].features[0].covariance_m2 = Eigen::Matrix2d::Identity();
  lists[1].features[0].position_m = {20.4, 0.0};
  lists[1].features[0].covariance_m2 = 3.0 * Eigen::Matrix2d::Identity();
  LandmarkEstimate landmark;
  landmark.type = "pole";
  landmark.mean_m = {20.3, 0.1};
  LandmarkSmootherParameters parameters;
  parameters.robust_chi2 = 1e6;
  parameters.least_evidence = 1e-3;
  const SmoothedLandmarks smoothed =
      smoothLandmarks(steps(lists, odometry), {{1, {}}, {2, {}}}, {landmark}, parameters);
  ASSERT_EQ(smoothed.map.landmarks.size(), 1U);
  EXPECT_NEAR(smoothed.map.landmarks[0].mean_m.x(), 20.1, 1e-3);
  EXPECT_NEAR(smoothed.map.landmarks[0].mean_m.y(), 0.0, 1e-3);
  // A fifth of 1 + 1/3 is new.
  const Eigen::Matrix2d wanted = 5.0 / (1.0 + 1.0 / 3.0) * Eigen::Matrix2d::Identity();
  EXPECT_LT((smoothed.map.landmarks[0].covariance_m2 - wanted).norm(), 0.01);
}

TEST(LandmarkSmoother, MendsAMapWithDuplicatesGhostsAndGaps) {
  const SyntheticDrive noisy = drive(cameraNoise());
  const Trajectory start = deadReckoning(noisy);
  std::vector<LandmarkEstimate> landmarks = roughMap(noisy, 0.05);
  landmarks[3].mean_m += Eigen::Vector2d(9.0, 9.0);  // a ghost, and what it stood for is missing
  landmarks[12].mean_m = landmarks[13].mean_m + Eigen::Vector2d(0.05, -0.05);  // a duplicate
  const SmoothedLandmarks smoothed = smoothLandmarks(steps(noisy), start, landmarks, {});
  EXPECT_LT(rmse(smoothed.trajectory, noisy), 0.2 * rmse(start, noisy));
  EXPECT_EQ(smoothed.map.landmarks.size(), noisy.landmarks_m.size());
  EXPECT_LT(worstMiss(smoothed.map, noisy), 0.12);                // half the least distance of two
  EXPECT_EQ(smoothed.map.landmarks.back().id, landmarks.size());  // never an identifier used before
}

TEST(LandmarkSmoother, GivesTheSameBytesAgain) {
  const SyntheticDrive noisy = drive(cameraNoise());
  const auto run = [&noisy] {
    return smoothLandmarks(steps(noisy), deadReckoning(noisy), roughMap(noisy, 0.05), {});
  };
  const SmoothedLandmarks first = run();
  const SmoothedLandmarks second = run();
  ASSERT_EQ(first.map.landmarks.size(), second.map.landmarks.size());
  for (std::size_t i = 0; i < first.map.landmarks.size(); ++i)
    EXPECT_EQ(first.map.landmarks[i].mean_m, second.map.landmarks[i].mean_m);
  EXPECT_EQ(first.trajectory.back().pose.x_m, second.trajectory.back().pose.x_m);
}

TEST(LandmarkSmoother, TakesListsWithoutFeaturesAndListsOfOneStamp) {
  const SyntheticDrive drive = ram_slam::drive({});
  std::vector<FeatureStep> empty = steps(drive);
  for (FeatureStep& step : empty) step.list.features.clear();
  EXPECT_EQ(smoothLandmarks({empty.front()}, deadReckoning(drive), {}, {}).trajectory.size(), 1U);
  EXPECT_TRUE(smoothLandmarks(empty, deadReckoning(drive), {}, {}).map.landmarks.empty());

  // One list in two parts, as two detectors publish it.
  std::vector<FeatureStep> halves;
  for (const FeatureStep& step : steps(drive)) {
    halves.insert(halves.end(), {step, step});
    const auto count = static_cast<std::ptrdiff_t>(step.list.features.size()) / 2;
    std::vector<Feature>& first = halves.end()[-2].list.features;
    std::vector<Feature>& second = halves.end()[-1].list.features;
    first.erase(first.begin() + count, first.end());
    second.erase(second.begin(), second.begin() + count);
    halves.back().motion = {};
  }
  const Trajectory start = deadReckoning(drive);
  const std::vector<LandmarkEstimate> map = roughMap(drive, 0.05);
  LandmarkSmootherParameters quick;
  quick.attempt_count = 0;
  const SmoothedLandmarks whole = smoothLandmarks(steps(drive), start, map, quick);
  const SmoothedLandmarks halved = smoothLandmarks(halves, start, map, quick);
  ASSERT_EQ(halved.trajectory.size(), whole.trajectory.size());
  EXPECT_EQ(halved.trajectory.back().pose.x_m, whole.trajectory.back().pose.x_m);
}

TEST(LandmarkSmoother, RefusesWhatItCannotUse) {
  const SyntheticDrive drive = ram_slam::drive({});
  const std::vector<FeatureStep> good = steps(drive);
  const Trajectory start = deadReckoning(drive);
  const auto run = [](const std::vector<FeatureStep>& steps, const Trajectory& trajectory) {
    return smoothLandmarks(steps, trajectory, {}, {});
  };
  EXPECT_TRUE(run({}, start).trajectory.empty());
  std::vector<FeatureStep> bad = good;
  std::swap(bad[3], bad[4]);
  EXPECT_THAT([&] { run(bad, start); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("come after")));
  EXPECT_THAT([&] { run(good, Trajectory(start.begin() + 1, start.end())); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("outside the trajectory")));
  bad = good;
  for (FeatureStep& step : bad) {
    for (Feature& feature : step.list.features) feature.covariance_m2.setZero();
  }
  EXPECT_THAT([&] { run(bad, start); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("positive definite")));
  bad = good;
  bad[5].motion.pose.x_m = std::nan("");
  EXPECT_THAT([&] { run(bad, start); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not finite")));
}

TEST(LandmarkSmoother, RefusesParametersOutOfBounds) {
  LandmarkSmootherParameters parameters;
  parameters.reading_share = 0.0;
  EXPECT_THAT([&] { parameters.validate(); }, ThrowsMessage<std::invalid_argument>(
                                                  "reading_share must be in (0, 1], got 0.000000"));
  parameters = {};
  parameters.first_deviation_m = 0.01;
  EXPECT_THAT([&] { parameters.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("first_deviation_m")));
  parameters = {};
  parameters.round_count = 0;
  EXPECT_THROW(parameters.validate(), std::invalid_argument);
}

}  // namespace
}  // namespace ram_slam
