// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/lidar_calibration.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "ram_slam/geometry/random.hpp"

namespace ram_slam {
namespace {

/// A pair of scans as they are with a lidar of these errors.
/// \param noise  of its residuals
ScanPairSum pairOf(const LidarCorrection& truth,
                   const LidarCorrection& known,
                   double noise,
                   Random& random) {
  ScanPairSum pair;
  Eigen::Matrix<double, 5, 1> state = Eigen::Matrix<double, 5, 1>::Zero();
  state << 0.001, -0.002, 0.0005, truth.turn_s - known.turn_s, truth.range_m - known.range_m;
  for (int i = 0; i < 100; ++i) {
    Eigen::Matrix<double, 5, 1> row;
    for (int k = 0; k < 5; ++k) row(k) = random.gaussian();
    // With the true state the residuals are the noise.
    const double residual = noise * random.gaussian() - row.dot(state);
    pair.information += row * row.transpose();
    pair.gradient += residual * row;
  }
  return pair;
}

LidarCalibration learnedFrom(const LidarCorrection& truth, int blocks, double noise) {
  LidarCalibrationParameters parameters;
  parameters.max_range_m = 0.05;
  LidarCalibration calibration(parameters);
  Random random(5);
  for (int i = 0; i < blocks; ++i) {
    for (int k = 0; k < 3; ++k)
      calibration.add(pairOf(truth, calibration.correction(), noise, random));
    calibration.endBlock();
  }
  return calibration;
}

TEST(LidarCalibration, FindsWhatMakesTheResidualsZeroWhateverThePoses) {
  const LidarCalibration found = learnedFrom({0.04, -0.012}, 30, 0.0);
  EXPECT_NEAR(found.correction().turn_s, 0.04, 1e-6);
  EXPECT_NEAR(found.correction().range_m, -0.012, 1e-6);
}

TEST(LidarCalibration, ItsDeviationsAreThoseOfTheLeastSquares) {
  constexpr double kNoise = 0.1;
  const LidarCalibration found = learnedFrom({0.04, -0.02}, 100, kNoise);
  const double expected = kNoise / std::sqrt(100 * 3 * 97.0);  // of 100 rows three go to the pose
  EXPECT_NEAR(found.deviation().turn_s, expected, 0.3 * expected);
  EXPECT_NEAR(found.correction().turn_s, 0.04, 4.0 * expected);
  EXPECT_NEAR(found.correction().range_m, -0.02, 4.0 * expected);
}

TEST(LidarCalibration, WaitsForEnoughKeyScans) {
  const int least = LidarCalibrationParameters().min_blocks;
  EXPECT_EQ(learnedFrom({0.04, 0.0}, least - 1, 0.0).correction(), LidarCorrection{});
  EXPECT_NE(learnedFrom({0.04, 0.0}, least, 0.0).correction().turn_s, 0.0);
}

TEST(LidarCalibration, OfWhatIsNotSignificantIsNone) {
  EXPECT_EQ(learnedFrom({0.0, 0.0}, 200, 0.1).correction(), LidarCorrection{});
  EXPECT_EQ(learnedFrom({0.006, 0.004}, 30, 0.5).correction(), LidarCorrection{});
}

TEST(LidarCalibration, UsesOneOfTwoIfOnlyThatIsSignificant) {
  const LidarCalibration found = learnedFrom({0.04, 0.0}, 100, 0.05);
  EXPECT_NEAR(found.correction().turn_s, 0.04, 0.002);
  EXPECT_EQ(found.correction().range_m, 0.0);
  EXPECT_EQ(found.deviation().range_m, 0.0);
}

TEST(LidarCalibration, LearnsNoOffsetUnlessAskedTo) {
  LidarCalibration calibration;
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    calibration.add(pairOf({0.04, 0.02}, calibration.correction(), 0.01, random));
    calibration.endBlock();
  }
  EXPECT_EQ(calibration.correction().range_m, 0.0);
  EXPECT_NEAR(calibration.correction().turn_s, 0.04, 0.002);
}

TEST(LidarCalibration, RefusesWhatNoLidarDoes) {
  EXPECT_EQ(learnedFrom({0.001, 0.001}, 100, 0.0).correction(), LidarCorrection{});
  EXPECT_EQ(learnedFrom({0.5, 0.2}, 100, 0.0).correction(), LidarCorrection{});
}

TEST(LidarCalibration, IsTakenBackWhenTheScansDoNotShowItAnyMore) {
  LidarCalibration calibration = learnedFrom({0.04, 0.0}, 100, 0.0);
  ASSERT_NE(calibration.correction().turn_s, 0.0);
  Random random(6);
  for (int i = 0; i < LidarCalibrationParameters().max_blocks; ++i) {
    calibration.add(pairOf({}, calibration.correction(), 0.01, random));
    calibration.endBlock();
  }
  EXPECT_EQ(calibration.correction(), LidarCorrection{});
}

TEST(LidarCalibration, LearnsNothingWithoutPairs) {
  LidarCalibration calibration;
  for (int i = 0; i < 100; ++i) calibration.endBlock();
  EXPECT_EQ(calibration.correction(), LidarCorrection{});
  EXPECT_EQ(toText(calibration), "as its driver states, as far as the scans show");
}

TEST(LidarCalibration, IsStatedInWords) {
  const std::string text = toText(learnedFrom({0.04, -0.012}, 30, 0.0));
  EXPECT_THAT(text, testing::HasSubstr("takes 40.0 ms (+- 0.0 ms) longer than stated; readings are "
                                       "12.0 mm (+- 0.0 mm) too long"));
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

TEST(CorrectedScan, TakesTheTimeOfATurnThatWasStatedAndWhatWasLearned) {
  const LaserScan scan = corrected(scanOfFour(), {2.0 * M_PI / 0.2 * 0.003, 0.0});
  EXPECT_NEAR(scan.time_increment_s, 0.004, 1e-12);
  EXPECT_EQ(scan.ranges_m, scanOfFour().ranges_m);
  EXPECT_EQ(scan.angle_min_rad, -0.3);
}

TEST(CorrectedScan, OfAMirrorThatTurnsClockwiseBeginsWithTheLastBeam) {
  const LaserScan scan = corrected(scanOfFour(), {2.0 * M_PI / 0.2 * -0.003, 0.0});
  EXPECT_NEAR(scan.time_increment_s, 0.002, 1e-12);
  EXPECT_NEAR(scan.angle_min_rad, 0.3, 1e-12);
  EXPECT_NEAR(scan.angle_increment_rad, -0.2, 1e-12);
  EXPECT_EQ(scan.ranges_m.front(), 2.0F);
  // Once more: the time of a counterclockwise turn is -0.002 s for each beam now.
  const LaserScan back = corrected(scan, {2.0 * M_PI / 0.2 * 0.003, 0.0});
  EXPECT_NEAR(back.time_increment_s, 0.001, 1e-12);
  EXPECT_NEAR(back.angle_min_rad, -0.3, 1e-12);
}

TEST(CorrectedScan, HasOtherReadingsWithinTheLimitsOnly) {
  const LaserScan scan = corrected(scanOfFour(), {0.0, 0.01});
  EXPECT_THAT(scan.ranges_m, testing::ElementsAre(testing::FloatNear(1.01F, 1e-6F), 5.0F,
                                                  std::numeric_limits<float>::infinity(),
                                                  testing::FloatNear(2.01F, 1e-6F)));
  EXPECT_EQ(scan.time_increment_s, 0.001);
}

}  // namespace
}  // namespace ram_slam
