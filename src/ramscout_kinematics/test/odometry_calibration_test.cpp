// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_kinematics/odometry_calibration.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "ramscout_kinematics/differential_drive.hpp"

#include "drives.hpp"

namespace ramscout_kinematics {
namespace {

using ram_slam::Pose2;
using ram_slam::PoseWithCovariance2;

constexpr double kSeparationM = 0.36;
constexpr double kIntervalM = 0.3;
constexpr int kPieces = 10;
constexpr double kObserverSigmaM = 0.002;
constexpr double kObserverSigmaRad = 0.001;

/// A robot whose wheels err as its noise model says, whose geometry errs as told, and that an
/// observer watches.
class Robot {
public:
  Robot(std::uint64_t seed, const WheelErrors& errors) : random_(seed), errors_(errors) {}

  /// One interval of a tour with turns to both sides; the noise's standard deviation times
  /// `noise_factor`.
  void drive(double noise_factor = 1.0) {
    ++interval_;
    const Eigen::Vector3d told(kIntervalM, 0.0, 0.2 * std::sin(0.13 * interval_));
    odometry_ = motionOf(told);
    truth_ = {};
    for (int i = 0; i < kPieces; ++i) {
      const Eigen::Vector3d piece = told / kPieces;
      const Eigen::Vector3d erred = piece + noise_factor * random_.gaussian(model_.noise(piece));
      truth_ = truth_ * ram_slam::exponential(corrected(erred, errors_, kSeparationM));
    }
  }
  /// What the observer says; the robot was pushed by `push` meanwhile.
  PoseWithCovariance2 observed(const Pose2& push = {}) {
    PoseWithCovariance2 observation;
    observation.covariance.diagonal() << std::pow(kObserverSigmaM, 2), std::pow(kObserverSigmaM, 2),
        std::pow(kObserverSigmaRad, 2);
    const Eigen::Vector3d error = random_.gaussian(observation.covariance);
    const Pose2 seen = truth_ * push;
    observation.pose = {seen.x_m + error.x(), seen.y_m + error.y(), seen.yaw_rad + error.z()};
    return observation;
  }
  const PoseWithCovariance2& odometry() const { return odometry_; }
  const Pose2& truth() const { return truth_; }

  PoseWithCovariance2 motionOf(const Eigen::Vector3d& told) const {
    Kinematics kinematics(unlimited(std::make_shared<DifferentialDrive>(model_)));
    addAll(kinematics, ramscout_kinematics::drive(told, 1.0, 1.0));
    return kinematics.motion(after(0.0), after(1.0));
  }

private:
  ram_slam::Random random_;
  WheelErrors errors_;
  DifferentialDrive model_{{kSeparationM, 1e-4, 1e-4}};
  int interval_ = 0;
  Pose2 truth_;
  PoseWithCovariance2 odometry_;
};

OdometryHealth watch(OdometryCalibration& calibration,
                     Robot& robot,
                     int intervals,
                     double noise_factor = 1.0) {
  OdometryHealth health;
  for (int i = 0; i < intervals; ++i) {
    robot.drive(noise_factor);
    health = calibration.update(robot.odometry(), robot.observed());
  }
  return health;
}

TEST(OdometryCalibration, FindsAWheelThatIsTwoPercentTooLarge) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(1, {0.02, 0.0, 0.0});
  watch(calibration, robot, 333);  // 100 m
  EXPECT_NEAR(calibration.errors().left, 0.02, 0.002);
  EXPECT_NEAR(calibration.errors().right, 0.0, 0.002);
  EXPECT_NEAR(calibration.errors().separation, 0.0,
              4.0 * std::sqrt(calibration.covariance()(2, 2)));
  ASSERT_TRUE(calibration.correction());
  EXPECT_NEAR(calibration.correction()->left, 0.02, 0.002);
}

TEST(OdometryCalibration, FindsASeparationThatIsThreePercentTooLarge) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(2, {0.0, 0.0, 0.03});
  watch(calibration, robot, 2000);
  EXPECT_NEAR(calibration.errors().separation, 0.03,
              4.0 * std::sqrt(calibration.covariance()(2, 2)));
  EXPECT_LT(std::sqrt(calibration.covariance()(2, 2)), 0.006);
}

TEST(OdometryCalibration, CorrectionTakesTheDriftAway) {
  const WheelErrors errors{0.02, -0.01, 0.0};
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(3, errors);
  watch(calibration, robot, 1000);
  ASSERT_TRUE(calibration.correction());
  Pose2 truth, raw, better;
  for (int i = 0; i < 333; ++i) {
    robot.drive(0.0);
    truth = truth * robot.truth();
    raw = raw * robot.odometry().pose;
    better = better * ram_slam::exponential(corrected(ram_slam::logarithm(robot.odometry().pose),
                                                      *calibration.correction(), kSeparationM));
  }
  const auto drift = [&](const Pose2& pose) {
    return std::abs(ram_slam::wrapAngle(pose.yaw_rad - truth.yaw_rad));
  };
  const double unwrapped_drift_rad = 333 * kIntervalM * 0.03 / kSeparationM;  // 7.5 rad
  EXPECT_LT(5.0 * drift(better), unwrapped_drift_rad);
  EXPECT_LT(5.0 * (better.translation() - truth.translation()).norm(),
            (raw.translation() - truth.translation()).norm());
}

TEST(OdometryCalibration, CorrectsNothingThatIsNotCertain) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(4, {0.04, 0.0, 0.0});
  watch(calibration, robot, 90);  // 27 m
  EXPECT_FALSE(calibration.correction());
}

TEST(OdometryCalibration, RarelyAlarmsWithoutReason) {
  int alarms = 0;
  int slips = 0;
  const int runs = 100, intervals = 500;  // 1000 windows of 50
  for (int run = 0; run < runs; ++run) {
    OdometryCalibration calibration{OdometryCalibrationParameters()};
    Robot robot(static_cast<std::uint64_t>(100 + run), {});
    bool alarmed = false;
    for (int i = 0; i < intervals; ++i) {
      const OdometryHealth health = watch(calibration, robot, 1);
      alarmed = alarmed || health.inconsistent || health.biased || health.stuck;
      slips += health.slipped ? 1 : 0;
    }
    alarms += alarmed ? 1 : 0;
  }
  EXPECT_LE(alarms,
            3);  // one expected at a rate of 1e-3 per window; more than 3 has a chance of 2 %
  EXPECT_LE(slips, 2);  // 0.05 expected
}

TEST(OdometryCalibration, FindsTheSizeOfTheNoise) {
  for (const double factor : {1.0, 2.0}) {
    double mean_scale = 0.0;
    OdometryCalibrationParameters parameters;
    OdometryCalibration calibration(parameters);
    Robot robot(5, {});
    watch(calibration, robot, 1000, factor);
    for (int i = 0; i < 2000; ++i) {
      watch(calibration, robot, 1, factor);
      mean_scale += calibration.noiseScale() / 2000.0;
    }
    EXPECT_NEAR(mean_scale, factor * factor, 0.15 * factor * factor);
  }
}

TEST(OdometryCalibration, TellsANoiseThatIsTwiceAsLargeAndThatItIsOver) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(6, {});
  EXPECT_FALSE(watch(calibration, robot, 200).inconsistent);
  EXPECT_TRUE(watch(calibration, robot, 40, 2.0).inconsistent);
  EXPECT_FALSE(watch(calibration, robot, 100).inconsistent);
}

TEST(OdometryCalibration, FlagsASlipInTheSameIntervalAndLearnsNothingFromIt) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(7, {});
  EXPECT_FALSE(watch(calibration, robot, 200).slipped);
  const WheelErrors before = calibration.errors();
  robot.drive();
  EXPECT_TRUE(calibration.update(robot.odometry(), robot.observed({-0.2, 0.0, 0.0})).slipped);
  EXPECT_EQ(calibration.errors().left, before.left);
  EXPECT_FALSE(watch(calibration, robot, 1).slipped);
}

TEST(OdometryCalibration, FlagsOdometryThatStandsStillWhileTheRobotMoves) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(8, {});
  watch(calibration, robot, 50);
  PoseWithCovariance2 still;
  still.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  for (int i = 1; i <= 4; ++i) {
    robot.drive();
    EXPECT_EQ(calibration.update(still, robot.observed()).stuck, i >= 3) << i;
  }
  EXPECT_FALSE(watch(calibration, robot, 1).stuck);
}

TEST(OdometryCalibration, AlertsToAGeometryThatIsFarOff) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(9, {0.08, 0.0, 0.0});
  EXPECT_TRUE(watch(calibration, robot, 500).biased);
}

TEST(OdometryCalibration, RefusesWhatIsNotFiniteAndStaysAsItWas) {
  OdometryCalibration calibration{OdometryCalibrationParameters()};
  Robot robot(10, {0.02, 0.0, 0.0});
  watch(calibration, robot, 50);
  const WheelErrors before = calibration.errors();
  const double scale = calibration.noiseScale();
  PoseWithCovariance2 bad = robot.observed();
  bad.pose.x_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(calibration.update(robot.odometry(), bad), std::invalid_argument);
  EXPECT_THROW(calibration.update({}, {}), std::invalid_argument);
  bad = robot.observed();
  bad.covariance(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(calibration.update(robot.odometry(), bad), std::invalid_argument);
  EXPECT_EQ(calibration.errors().left, before.left);
  EXPECT_EQ(calibration.noiseScale(), scale);
}

}  // namespace
}  // namespace ramscout_kinematics
