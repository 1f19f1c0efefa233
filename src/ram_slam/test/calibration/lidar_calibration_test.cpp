// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/lidar_calibration.hpp"

#include <cmath>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

/// A pair of scans of a lidar whose mirror turn takes `added_s` longer than stated.
/// \param known_s  the part by which they were corrected
/// \param noise    of their residuals
ScanPairSum pairOf(double added_s, double known_s, double noise, Random& random) {
  ScanPairSum pair;
  const Eigen::Vector4d state(0.001, -0.002, 0.0005, added_s - known_s);
  for (int i = 0; i < 100; ++i) {
    Eigen::Vector4d row;
    for (int k = 0; k < 4; ++k) row(k) = random.gaussian();
    // With the true state the residuals are the noise.
    const double residual = noise * random.gaussian() - row.dot(state);
    pair.information += row * row.transpose();
    pair.gradient += residual * row;
  }
  return pair;
}

/// Of scans that follow each other by more than any correction that is allowed.
constexpr LidarCalibration::Timing kSlow{0.6, 0.0};

LidarCalibration learnedFrom(double added_s, int blocks, double noise) {
  LidarCalibration calibration;
  Random random(5);
  for (int i = 0; i < blocks; ++i) {
    for (int k = 0; k < 3; ++k)
      calibration.add(pairOf(added_s, calibration.addedMirrorTurn_s(), noise, random), kSlow);
    calibration.endBlock();
  }
  return calibration;
}

/// What is added where a mirror turn takes `added_s` longer than `stated_s`, and scans follow each
/// other by 0.05 s in the mean.
double learnedAtTwentyHertz(double stated_s, double added_s, double noise) {
  LidarCalibration calibration;
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const double known_s = calibration.addedMirrorTurn_s();
    for (const double interval_s : {0.02, 0.08})  // stamps that jitter
      calibration.add(pairOf(added_s, known_s, noise, random), {interval_s, stated_s + known_s});
    calibration.endBlock();
  }
  return calibration.addedMirrorTurn_s();
}

TEST(LidarCalibration, FindsWhatMakesTheResidualsZeroWhateverThePoses) {
  EXPECT_NEAR(learnedFrom(0.04, 30, 0.0).addedMirrorTurn_s(), 0.04, 1e-6);
  EXPECT_NEAR(learnedFrom(-0.04, 30, 0.0).addedMirrorTurn_s(), -0.04, 1e-6);
}

TEST(LidarCalibration, ItsDeviationIsThatOfTheLeastSquares) {
  constexpr double kNoise = 0.1;
  const LidarCalibration found = learnedFrom(0.04, 100, kNoise);
  const double expected = kNoise / std::sqrt(100 * 3 * 97.0);  // of 100 rows three go to the pose
  EXPECT_NEAR(found.deviation_s(), expected, 0.3 * expected);
  EXPECT_NEAR(found.addedMirrorTurn_s(), 0.04, 4.0 * expected);
}

TEST(LidarCalibration, WaitsForEnoughKeyScans) {
  const int least = LidarCalibrationParameters().min_blocks;
  EXPECT_EQ(learnedFrom(0.04, least - 1, 0.0).addedMirrorTurn_s(), 0.0);
  EXPECT_NE(learnedFrom(0.04, least, 0.0).addedMirrorTurn_s(), 0.0);
}

TEST(LidarCalibration, OfWhatIsNotSignificantIsNone) {
  for (const auto& [added_s, blocks, noise] :
       {std::tuple{0.0, 200, 0.1}, std::tuple{0.006, 30, 0.5}}) {
    const LidarCalibration found = learnedFrom(added_s, blocks, noise);
    EXPECT_EQ(found.addedMirrorTurn_s(), 0.0);
    EXPECT_EQ(found.deviation_s(), 0.0);
  }
}

TEST(LidarCalibration, RefusesWhatNoLidarDoes) {
  EXPECT_EQ(learnedFrom(0.001, 100, 0.0).addedMirrorTurn_s(), 0.0);
  EXPECT_EQ(learnedFrom(0.5, 100, 0.0).addedMirrorTurn_s(), 0.0);
}

TEST(LidarCalibration, RefusesAMirrorTurnThatTakesLongerThanTheTimeBetweenScans) {
  EXPECT_NEAR(learnedAtTwentyHertz(0.0, 0.04, 0.01), 0.04, 0.001);
  EXPECT_EQ(learnedAtTwentyHertz(0.0, 0.06, 0.01), 0.0);
  EXPECT_NEAR(learnedAtTwentyHertz(0.0, -0.04, 0.01), -0.04, 0.001);
  EXPECT_EQ(learnedAtTwentyHertz(0.0, -0.06, 0.01), 0.0);
}

TEST(LidarCalibration, CountsWhatIsStatedWhereAMirrorTurnMustFitBetweenScans) {
  EXPECT_EQ(learnedAtTwentyHertz(0.02, 0.04, 0.01), 0.0);
  EXPECT_NEAR(learnedAtTwentyHertz(0.03, -0.06, 0.01), -0.06, 0.001);
}

TEST(LidarCalibration, TakesAMirrorTurnThatLastsFromScanToScan) {
  EXPECT_NEAR(learnedAtTwentyHertz(0.0, 0.05, 0.1), 0.05, 0.004);
}

TEST(LidarCalibration, LearnsNothingIfNoCorrectionIsAllowed) {
  LidarCalibrationParameters parameters;
  parameters.max_turn_s = 0.0;
  LidarCalibration calibration(parameters);
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    calibration.add(pairOf(0.04, 0.0, 0.01, random), kSlow);
    calibration.endBlock();
  }
  EXPECT_EQ(calibration.addedMirrorTurn_s(), 0.0);
}

TEST(LidarCalibration, IsTakenBackWhenTheScansDoNotShowItAnyMore) {
  LidarCalibration calibration = learnedFrom(0.04, 100, 0.0);
  ASSERT_NE(calibration.addedMirrorTurn_s(), 0.0);
  Random random(6);
  for (int i = 0; i < LidarCalibrationParameters().max_blocks; ++i) {
    calibration.add(pairOf(0.0, calibration.addedMirrorTurn_s(), 0.01, random), kSlow);
    calibration.endBlock();
  }
  EXPECT_EQ(calibration.addedMirrorTurn_s(), 0.0);
}

TEST(LidarCalibration, LearnsNothingWithoutPairs) {
  LidarCalibration calibration;
  for (int i = 0; i < 100; ++i) calibration.endBlock();
  EXPECT_EQ(calibration.addedMirrorTurn_s(), 0.0);
  EXPECT_EQ(toText(calibration), "as its driver states, as far as the scans show");
}

TEST(LidarCalibration, IsStatedInWords) {
  EXPECT_EQ(toText(learnedFrom(0.04, 30, 0.0)),
            "one turn of the mirror takes 40.0 ms (+- 0.0 ms) longer than stated");
  EXPECT_EQ(toText(learnedFrom(-0.04, 30, 0.0)),
            "one turn of the mirror takes 40.0 ms (+- 0.0 ms) less than stated, or is clockwise");
}

LaserScan scanOfFour() {
  LaserScan scan;
  scan.angle_min_rad = -0.3;
  scan.angle_increment_rad = 0.2;
  scan.time_increment_s = 0.001;
  scan.range_min_m = 0.1F;
  scan.range_max_m = 5.0F;
  scan.ranges_m = {1.0F, 4.995F, std::numeric_limits<float>::infinity(), 2.0F};
  return scan;
}

TEST(CorrectedScan, TakesTheTimeOfAMirrorTurnThatWasStatedAndWhatWasLearned) {
  const LaserScan scan = corrected(scanOfFour(), 2.0 * M_PI / 0.2 * 0.003);
  EXPECT_NEAR(scan.time_increment_s, 0.004, 1e-12);
  EXPECT_EQ(scan.ranges_m, scanOfFour().ranges_m);
  EXPECT_EQ(scan.angle_min_rad, -0.3);
}

TEST(CorrectedScan, OfAMirrorThatTurnsClockwiseBeginsWithTheLastBeam) {
  const LaserScan scan = corrected(scanOfFour(), 2.0 * M_PI / 0.2 * -0.003);
  EXPECT_NEAR(scan.time_increment_s, 0.002, 1e-12);
  EXPECT_NEAR(scan.angle_min_rad, 0.3, 1e-12);
  EXPECT_NEAR(scan.angle_increment_rad, -0.2, 1e-12);
  EXPECT_EQ(scan.ranges_m.front(), 2.0F);
  // Once more: the time of a counterclockwise turn is -0.002 s for each beam now.
  const LaserScan back = corrected(scan, 2.0 * M_PI / 0.2 * 0.003);
  EXPECT_NEAR(back.time_increment_s, 0.001, 1e-12);
  EXPECT_NEAR(back.angle_min_rad, -0.3, 1e-12);
}

TEST(MirrorTurn, IsThatOfAllAnglesAndNegativeIfClockwise) {
  EXPECT_NEAR(mirrorTurn_s(scanOfFour()), 0.001 * 2.0 * M_PI / 0.2, 1e-12);
  EXPECT_NEAR(mirrorTurn_s(mirrored(scanOfFour())), -0.001 * 2.0 * M_PI / 0.2, 1e-12);
}

TEST(CorrectedScan, IsTheSameIfNothingIsAdded) {
  const LaserScan scan = corrected(inSweepDirection(SweepDirection::kClockwise, scanOfFour()), 0.0);
  EXPECT_EQ(scan.time_increment_s, 0.001);
  EXPECT_NEAR(scan.angle_increment_rad, -0.2, 1e-12);
}

}  // namespace
}  // namespace ram_slam
