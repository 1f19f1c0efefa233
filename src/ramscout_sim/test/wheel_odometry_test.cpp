// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/wheel_odometry.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <gmock/gmock.h>

namespace ramscout_sim {
namespace {

constexpr double kRadius_m = 0.1;
constexpr double kTrack_m = 0.36;
constexpr std::int64_t kPeriod_ns = 10'000'000;

RobotDescription ramscout() {
  return readRobot(CONFIG_FOLDER "/robots/ramscout.urdf");
}

OdometryParameters perfect() {
  OdometryParameters p;
  p.wheel_diameter_ratio = 1.0;
  p.track_ratio = 1.0;
  p.ticks_per_turn = 10000000;
  p.slip_distance_sigma_per_sqrt_m = 0.0;
  p.slip_yaw_sigma_rad_per_sqrt_m = 0.0;
  p.slip_yaw_sigma_rad_per_sqrt_rad = 0.0;
  return p;
}

TEST(WheelOdometry, FollowsAQuarterCircle) {
  WheelOdometry odometry(ramscout(), perfect(), 1);
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

TEST(WheelOdometry, CountsWholeTicks) {
  OdometryParameters parameters = perfect();
  parameters.ticks_per_turn = 360;
  WheelOdometry odometry(ramscout(), parameters, 1);
  odometry.update(0, {});
  const OdometryReading reading = odometry.update(kPeriod_ns, {0.1, 0.1});  // 5.73 ticks
  EXPECT_NEAR(reading.wheel_angles_rad.left, 6 * 2.0 * M_PI / 360, 1e-12);
}

TEST(WheelOdometry, SlipsWithAVarianceThatGrowsWithTheWayAndThatItReports) {
  OdometryParameters parameters = perfect();
  parameters.slip_yaw_sigma_rad_per_sqrt_m = 0.01;
  constexpr int kRuns = 400;
  constexpr double kWay_m = 4.0;
  double sum_of_squares = 0.0;
  const RobotDescription robot = ramscout();
  OdometryReading reading;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    WheelOdometry odometry(robot, parameters, seed);
    for (int i = 0; i <= 400; ++i) {
      const double angle_rad = kWay_m * i / 400 / kRadius_m;
      reading = odometry.update(i * kPeriod_ns, {angle_rad, angle_rad});
    }
    sum_of_squares += reading.odom_from_base.yaw_rad * reading.odom_from_base.yaw_rad;
  }
  const double expected = 0.01 * 0.01 * kWay_m;
  EXPECT_NEAR(sum_of_squares / kRuns, expected, 3.0 * expected * std::sqrt(2.0 / kRuns));
  EXPECT_NEAR(reading.covariance(2, 2), expected, 0.1 * expected);
}

TEST(OdometryParameters, AreRefusedByName) {
  for (const char* text : {"{track_ratio: 3}", "{wheel_diameter_ratio: 0}", "{ticks_per_turn: 1}",
                           "{slip_distance_sigma_per_sqrt_m: -1}", "{slip: 1}"}) {
    ram_parameters::ParameterReader reader(YAML::Load(text), "odometry");
    EXPECT_THROW(readOdometryParameters(reader), std::invalid_argument) << text;
  }
}

TEST(WheelOdometry, BuildsTheErrorsIntoTheRealRobotAndKeepsTheMeanDiameter) {
  OdometryParameters parameters;
  parameters.wheel_diameter_ratio = 1.02;
  parameters.track_ratio = 1.05;
  const RobotDescription real = withTrueGeometry(ramscout(), parameters);
  EXPECT_NEAR(real.right.radius_m / real.left.radius_m, 1.02, 1e-12);
  EXPECT_NEAR(real.right.radius_m + real.left.radius_m, 2.0 * kRadius_m, 1e-12);
  EXPECT_NEAR(real.trackWidth_m(), 1.05 * kTrack_m, 1e-12);
}

}  // namespace
}  // namespace ramscout_sim
