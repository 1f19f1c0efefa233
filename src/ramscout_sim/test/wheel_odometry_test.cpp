// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/wheel_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "shared.hpp"
#include "spoiled_parameters.hpp"

namespace ramscout_sim {
namespace {

using ::testing::HasSubstr;
using testing::shippedRobot;

constexpr double kRadius_m = 0.1;
constexpr double kTrack_m = 0.36;
constexpr std::int64_t kPeriod_ns = 10'000'000;

OdometryParameters withoutErrors() {
  OdometryParameters p;
  p.wheel_diameter_ratio = p.track_ratio = 1.0;
  p.slip_distance_sigma_per_sqrt_m = 0.0;
  p.slip_yaw_sigma_rad_per_sqrt_m = 0.0;
  p.slip_yaw_sigma_rad_per_sqrt_rad = 0.0;
  p.wheel_diameter_ratio_tolerance = p.track_ratio_tolerance = 0.0;
  return p;
}

/// A leg of a drive: how far, and how much it turns meanwhile.
struct Leg {
  double distance_m;
  double yaw_rad;
};

/// Turns the wheels of a robot of perfect geometry; true wheels of another size turn accordingly.
class Drive {
public:
  Drive(const OdometryParameters& parameters, std::uint64_t seed)
      : robot_(withTrueGeometry(shippedRobot(), parameters)),
        odometry_(shippedRobot(), parameters, seed) {
    reading_ = odometry_.update(0, {});
  }

  void go(const Leg& leg) {
    const int steps = 1 + static_cast<int>(std::max(std::abs(leg.distance_m) / 0.008,
                                                    std::abs(leg.yaw_rad) / 0.01));
    for (int i = 0; i < steps; ++i) {
      // The nominal wheels turn as commanded; the true robot moves as its true geometry makes it.
      const double left_rad = (leg.distance_m - 0.5 * kTrack_m * leg.yaw_rad) / kRadius_m / steps;
      const double right_rad = (leg.distance_m + 0.5 * kTrack_m * leg.yaw_rad) / kRadius_m / steps;
      angles_[0] += left_rad;
      angles_[1] += right_rad;
      const double left_m = left_rad * robot_.wheels[0].radius_m;
      const double right_m = right_rad * robot_.wheels[1].radius_m;
      const double yaw_rad = (right_m - left_m) / robot_.trackWidth_m();
      const double half = 0.5 * yaw_rad;
      truth_ = truth_ * Pose2{0.5 * (left_m + right_m) * std::cos(half),
                              0.5 * (left_m + right_m) * std::sin(half), yaw_rad};
      stamp_ns_ += kPeriod_ns;
      reading_ = odometry_.update(stamp_ns_, angles_);
    }
  }

  const OdometryReading& reading() const { return reading_; }

  /// Estimate minus truth.
  Eigen::Vector3d error() const {
    const Pose2& estimate = reading_.odom_from_base;
    return {estimate.x_m - truth_.x_m, estimate.y_m - truth_.y_m,
            wrapAngle(estimate.yaw_rad - truth_.yaw_rad)};
  }

private:
  RobotDescription robot_;
  WheelOdometry odometry_;
  Pose2 truth_;
  WheelValues angles_ = {};
  std::int64_t stamp_ns_ = 0;
  OdometryReading reading_;
};

/// Twice around a block, as in the shipped office.
const std::vector<Leg> kLoop = {{17.0, 0.0}, {0.5, M_PI_2}, {12.0, 0.0}, {0.0, M_PI_2},
                                {17.0, 0.0}, {0.5, M_PI_2}, {12.0, 0.0}, {0.0, M_PI_2}};

TEST(WheelOdometry, FollowsAQuarterCircle) {
  OdometryParameters parameters = withoutErrors();
  parameters.ticks_per_turn = 10'000'000;
  WheelOdometry odometry(shippedRobot(), parameters, 1);
  constexpr double kCircle_m = 2.0;
  constexpr int kSteps = 100;
  OdometryReading reading;
  for (int i = 0; i <= kSteps; ++i) {
    const double turned_rad = M_PI_2 * i / kSteps;
    reading =
        odometry.update(i * kPeriod_ns, {turned_rad * (kCircle_m - 0.5 * kTrack_m) / kRadius_m,
                                         turned_rad * (kCircle_m + 0.5 * kTrack_m) / kRadius_m});
  }
  EXPECT_NEAR(reading.odom_from_base.x_m, kCircle_m, 1e-6);
  EXPECT_NEAR(reading.odom_from_base.y_m, kCircle_m, 1e-6);
  EXPECT_NEAR(reading.odom_from_base.yaw_rad, M_PI_2, 1e-6);
  EXPECT_NEAR(reading.twist.turn_radps, M_PI_2, 1e-3);
}

TEST(WheelOdometry, FindsBackOnAClosedWay) {
  Drive drive(withoutErrors(), 1);
  for (const Leg& leg : kLoop) drive.go(leg);
  EXPECT_LT(drive.error().norm(), 2e-3);  // ticks of 0.15 mm at each end of the axle
  EXPECT_NEAR(drive.reading().odom_from_base.yaw_rad, 0.0, 2e-3);
}

TEST(WheelOdometry, CountsWholeTicksWithoutDrift) {
  OdometryParameters parameters = withoutErrors();
  parameters.ticks_per_turn = 360;
  WheelOdometry odometry(shippedRobot(), parameters, 1);
  odometry.update(0, {5.0, 5.0});
  const double tick_rad = 2.0 * M_PI / 360.0;
  for (int i = 1; i < 5000; ++i) {
    const double turned_rad = 0.0137 * i;
    const OdometryReading reading =
        odometry.update(i * kPeriod_ns, {5.0 + turned_rad, 5.0 + turned_rad});
    const double ticks = reading.wheel_angles_rad[0] / tick_rad;
    ASSERT_NEAR(ticks, std::round(ticks), 1e-6);
    ASSERT_LE(std::abs(reading.wheel_angles_rad[0] - turned_rad), 0.5 * tick_rad + 1e-9);
    ASSERT_NEAR(reading.odom_from_base.x_m, kRadius_m * reading.wheel_angles_rad[0], 1e-9);
  }
}

TEST(WheelOdometry, ReportsTheSpeedBetweenTwoReadings) {
  OdometryParameters parameters = withoutErrors();
  parameters.ticks_per_turn = 10'000'000;
  WheelOdometry odometry(shippedRobot(), parameters, 1);
  odometry.update(0, {});
  const OdometryReading reading = odometry.update(kPeriod_ns, {0.04, 0.06});
  EXPECT_NEAR(reading.twist.forward_mps, 0.5, 1e-3);
  EXPECT_NEAR(reading.twist.turn_radps, 0.1 * 0.02 / 0.36 / 0.01, 1e-3);
  EXPECT_NEAR(reading.wheel_speeds_radps[1], 6.0, 1e-3);
}

TEST(WheelOdometry, KeepsTheMeanDiameterAndAppliesBothRatios) {
  OdometryParameters parameters;
  parameters.wheel_diameter_ratio = 1.02;
  parameters.track_ratio = 0.95;
  const RobotDescription robot = withTrueGeometry(shippedRobot(), parameters);
  EXPECT_NEAR(robot.wheels[1].radius_m / robot.wheels[0].radius_m, 1.02, 1e-12);
  EXPECT_NEAR(robot.wheels[1].radius_m + robot.wheels[0].radius_m, 2.0 * kRadius_m, 1e-12);
  EXPECT_NEAR(robot.trackWidth_m(), 0.95 * kTrack_m, 1e-12);
}

TEST(WheelOdometry, SlipGrowsWithTheRootOfTheWay) {
  OdometryParameters parameters = withoutErrors();
  parameters.ticks_per_turn = 1'000'000;
  parameters.slip_distance_sigma_per_sqrt_m = 0.01;
  parameters.slip_yaw_sigma_rad_per_sqrt_m = 0.001;
  constexpr int kRuns = 800;
  for (const double way_m : {1.0, 4.0}) {
    double distance = 0.0;
    double yaw = 0.0;
    for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
      Drive drive(parameters, seed);
      drive.go({way_m, 0.0});
      distance += drive.error().x() * drive.error().x();
      yaw += drive.error().z() * drive.error().z();
    }
    // Relative standard error of a variance: sqrt(2 / n) = 5 %; three of them.
    EXPECT_NEAR(distance / kRuns / (1e-4 * way_m), 1.0, 0.15);
    EXPECT_NEAR(yaw / kRuns / (1e-6 * way_m), 1.0, 0.15);
  }
}

/// Mean over seeds of the squared error in units of the published covariance; 3 if that is
/// consistent.
double meanNees(const OdometryParameters& parameters, int runs) {
  double sum = 0.0;
  for (int seed = 0; seed < runs; ++seed) {
    Drive drive(parameters, static_cast<std::uint64_t>(seed));
    for (const Leg& leg : kLoop) drive.go(leg);
    sum += drive.error().dot(drive.reading().covariance.ldlt().solve(drive.error()));
  }
  return sum / runs;
}

TEST(WheelOdometry, TheCovarianceOfPureSlipIsHonest) {
  OdometryParameters parameters;
  parameters.wheel_diameter_ratio = parameters.track_ratio = 1.0;
  parameters.wheel_diameter_ratio_tolerance = parameters.track_ratio_tolerance = 0.0;
  constexpr int kRuns = 300;
  EXPECT_NEAR(meanNees(parameters, kRuns), 3.0, 3.0 * std::sqrt(6.0 / kRuns));
}

TEST(WheelOdometry, TheCovarianceOfARobotOffByItsTolerancesIsHonest) {
  // Both ratios off by one standard deviation, as the defaults are, in all four combinations: their
  // mean square is that of the tolerances.
  OdometryParameters parameters;
  const double ed = parameters.wheel_diameter_ratio_tolerance;
  const double eb = parameters.track_ratio_tolerance;
  EXPECT_NEAR(parameters.wheel_diameter_ratio, 1.0 + ed, 1e-12);
  EXPECT_NEAR(parameters.track_ratio, 1.0 + eb, 1e-12);
  constexpr int kRuns = 80;
  double sum = 0.0;
  for (const double ed_sign : {-1.0, 1.0}) {
    for (const double eb_sign : {-1.0, 1.0}) {
      parameters.wheel_diameter_ratio = 1.0 + ed_sign * ed;
      parameters.track_ratio = 1.0 + eb_sign * eb;
      sum += 0.25 * meanNees(parameters, kRuns);
    }
  }
  EXPECT_NEAR(sum, 3.0, 3.0 * std::sqrt(6.0 / (4.0 * kRuns)));
}

TEST(WheelOdometry, TheSpeedsCovarianceIsHonest) {
  const OdometryParameters parameters;
  WheelOdometry odometry(shippedRobot(), parameters, 3);
  odometry.update(0, {});
  double forward = 0.0;
  double turn = 0.0;
  constexpr int kCount = 5000;
  for (int i = 1; i <= kCount; ++i) {
    const OdometryReading reading = odometry.update(i * kPeriod_ns, {0.0731 * i, 0.0913 * i});
    const double forward_error = reading.twist.forward_mps - 0.5 * 0.1 * (7.31 + 9.13);
    const double turn_error = reading.twist.turn_radps - 0.1 * (9.13 - 7.31) / kTrack_m;
    forward += forward_error * forward_error / reading.twist_covariance(0, 0) / kCount;
    turn += turn_error * turn_error / reading.twist_covariance(2, 2) / kCount;
  }
  EXPECT_NEAR(forward, 1.0, 0.1);
  EXPECT_NEAR(turn, 1.0, 0.1);
}

TEST(WheelOdometry, RefusesBadParametersByName) {
  const auto refusal = &testing::refusalOfSpoiled<OdometryParameters>;
  EXPECT_THAT(refusal([](OdometryParameters& p) { p.ticks_per_turn = 0; }),
              HasSubstr("ticks_per_turn"));
  EXPECT_THAT(refusal([](OdometryParameters& p) { p.track_ratio = 0; }), HasSubstr("track_ratio"));
  EXPECT_THAT(refusal([](OdometryParameters& p) { p.slip_distance_sigma_per_sqrt_m = -1; }),
              HasSubstr("slip_distance_sigma_per_sqrt_m"));
  EXPECT_THAT(refusal([](OdometryParameters& p) { p.track_ratio_tolerance = std::nan(""); }),
              HasSubstr("track_ratio_tolerance"));
}

TEST(OdometryParameters, AreRefusedAsReadFromAFile) {
  for (const char* text : {"{track_ratio: 3}", "{wheel_diameter_ratio: 0}", "{ticks_per_turn: 1}",
                           "{slip_distance_sigma_per_sqrt_m: -1}", "{slip: 1}"}) {
    ram_parameters::ParameterReader reader(YAML::Load(text), "odometry");
    EXPECT_THROW(OdometryParameters::table().readAll(reader), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace ramscout_sim
