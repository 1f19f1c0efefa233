// SPDX-License-Identifier: BSD-3-Clause
// Cars and bases with omni wheels, from command to odometry.
#include "ramscout_sim/drive.hpp"

#include <cmath>
#include <optional>
#include <string>

#include <gmock/gmock.h>

#include "ramscout_sim/simulation.hpp"

#include "shared.hpp"

namespace ramscout_sim {
namespace {

using ::testing::HasSubstr;

RobotDescription shipped(const std::string& name) {
  return readRobot(std::string(CONFIG_FOLDER) + "/robots/" + name + ".urdf");
}

Simulation simulate(const RobotDescription& robot, const OdometryParameters& odometry) {
  SimulationParameters parameters;
  parameters.odometry = odometry;
  return {parameters, robot, World(), std::nullopt};
}

OdometryParameters withoutErrors() {
  OdometryParameters p;
  p.wheel_diameter_ratio = p.track_ratio = 1.0;
  p.ticks_per_turn = 1'000'000;
  p.slip_distance_sigma_per_sqrt_m = p.slip_yaw_sigma_rad_per_sqrt_m = 0.0;
  p.slip_yaw_sigma_rad_per_sqrt_rad = 0.0;
  return p;
}

/// What came last while the command was renewed.
Outputs obey(Simulation& simulation, const Twist2& twist, double duration_s) {
  Outputs last;
  for (int i = 0; i < std::lround(1000.0 * duration_s); ++i) {
    simulation.command(twist);
    const Outputs outputs = simulation.step();
    if (outputs.odometry) last = outputs;
  }
  return last;
}

void expectOdometryIsTheTruth(const Outputs& outputs, double tolerance) {
  const Pose2 truth = toPose2(outputs.ground_truth->world_from_base);
  const Pose2& odometry = outputs.odometry->odom_from_base;
  EXPECT_NEAR(odometry.x_m, truth.x_m, tolerance);
  EXPECT_NEAR(odometry.y_m, truth.y_m, tolerance);
  EXPECT_NEAR(wrapAngle(odometry.yaw_rad - truth.yaw_rad), 0.0, tolerance);
}

TEST(Drive, WheelsOfTwoSidesTurnWithTheTrack) {
  Drive drive(shipped("ramscout"), {});
  WheelMotion motion;
  for (int i = 0; i < 3000; ++i) motion = drive.advance({0.5, 0.3, 1.0}, 1e-3);
  EXPECT_NEAR(motion.speeds_radps[0], (0.5 - 0.18) / 0.1, 1e-9);
  EXPECT_NEAR(motion.speeds_radps[1], (0.5 + 0.18) / 0.1, 1e-9);
}

TEST(Drive, AllWheelsOfACarPointToOneCentre) {
  const RobotDescription robot = shipped("car");
  Drive drive(robot, {});
  WheelMotion motion;
  constexpr double kTurn_m = 1.25;
  for (int i = 0; i < 3000; ++i) motion = drive.advance({0.5, 0.0, 0.5 / kTurn_m}, 1e-3);
  EXPECT_NEAR(motion.speeds_radps[0], 0.5 / 0.1 * (kTurn_m - 0.18) / kTurn_m, 1e-9);
  for (const std::size_t i : {2U, 3U}) {
    const Eigen::Vector3d& at = robot.wheels[i].center_in_base_m;
    EXPECT_NEAR(std::tan(motion.steering_rad[i]), at.x() / (kTurn_m - at.y()), 1e-9);
    EXPECT_NEAR(motion.speeds_radps[i], 0.5 / 0.1 * std::hypot(at.x(), kTurn_m - at.y()) / kTurn_m,
                1e-9);
  }
}

TEST(Drive, ACarsSteeringStaysWithinAngleAndSpeed) {
  Drive drive(shipped("car"), {});
  double last_rad = 0.0;
  double largest_rad = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const WheelMotion motion = drive.advance({0.3, 0.0, i < 1500 ? 3.0 : -3.0}, 1e-3);
    ASSERT_LE(std::abs(motion.steering_rad[2] - last_rad), 2e-3 * 1.5);
    last_rad = motion.steering_rad[2];
    largest_rad = std::max({largest_rad, motion.steering_rad[2], -motion.steering_rad[3]});
  }
  EXPECT_NEAR(largest_rad, 0.6, 1e-9);
}

TEST(Drive, ACarThatStandsKeepsItsSteering) {
  Drive drive(shipped("car"), {});
  for (int i = 0; i < 2000; ++i) drive.advance({0.3, 0.0, 0.1}, 1e-3);
  const double before_rad = drive.advance({0.3, 0.0, 0.1}, 1e-3).steering_rad[2];
  EXPECT_GT(before_rad, 0.05);
  EXPECT_EQ(drive.advance({0.0, 0.0, 1.0}, 1e-3).steering_rad[2], before_rad);
}

TEST(Drive, MotionOfOmniWheelsIsFoundAgain) {
  const RobotDescription robot = shipped("omni");
  const Eigen::MatrixXd product = motionFromRimSpeed(robot) * rimSpeedFromMotion(robot);
  EXPECT_TRUE(product.isApprox(Eigen::MatrixXd::Identity(3, 3), 1e-9));
}

TEST(Car, DrivesACircleOfTheCommandedCurvature) {
  Simulation simulation = simulate(shipped("car"), withoutErrors());
  constexpr double kTurn_m = 1.5;
  const Twist2 twist{0.6, 0.0, 0.6 / kTurn_m};
  obey(simulation, twist, 3.0);
  const Pose2 begin = toPose2(simulation.groundTruth().world_from_base);
  const Eigen::Vector2d center =
      Eigen::Vector2d(begin.x_m, begin.y_m) +
      kTurn_m * Eigen::Vector2d(-std::sin(begin.yaw_rad), std::cos(begin.yaw_rad));
  double farthest_m = 0.0;
  for (int i = 0; i < 160; ++i) {
    const Outputs outputs = obey(simulation, twist, 0.1);
    const Pose2 pose = toPose2(simulation.groundTruth().world_from_base);
    farthest_m = std::max(
        farthest_m, std::abs((Eigen::Vector2d(pose.x_m, pose.y_m) - center).norm() - kTurn_m));
    expectOdometryIsTheTruth(outputs, 2e-3);
  }
  EXPECT_LT(farthest_m, 1e-3);
  EXPECT_NEAR(simulation.groundTruth().angular_velocity_radps.z(), 0.6 / kTurn_m, 1e-3);
}

TEST(Car, CannotTurnOnTheSpot) {
  Simulation simulation = simulate(shipped("car"), withoutErrors());
  const Outputs outputs = obey(simulation, {0.0, 0.0, 1.0}, 2.0);
  EXPECT_NEAR(toPose2(outputs.ground_truth->world_from_base).yaw_rad, 0.0, 1e-9);
}

TEST(Omni, DrivesStraightToTheSide) {
  Simulation simulation = simulate(shipped("omni"), withoutErrors());
  const Outputs outputs = obey(simulation, {0.0, 0.5, 0.0}, 5.0);
  const Pose2 truth = toPose2(outputs.ground_truth->world_from_base);
  EXPECT_NEAR(truth.x_m, 0.0, 1e-4);
  EXPECT_NEAR(truth.y_m, 0.5 * (5.0 - 0.25), 0.5 * 0.01);  // odometry comes every 10 ms
  EXPECT_NEAR(truth.yaw_rad, 0.0, 1e-4);
  EXPECT_NEAR(outputs.odometry->twist.left_mps, 0.5, 2e-3);
  expectOdometryIsTheTruth(outputs, 1e-3);
}

TEST(Omni, DrivesAStraightLineWhileItTurns) {
  Simulation simulation = simulate(shipped("omni"), withoutErrors());
  for (int i = 0; i < 600; ++i) {
    const double yaw_rad = toPose2(simulation.groundTruth().world_from_base).yaw_rad;
    // Towards +y of the world, whatever the heading.
    const Outputs outputs =
        obey(simulation, {0.3 * std::sin(yaw_rad), 0.3 * std::cos(yaw_rad), 0.5}, 0.01);
    if (i == 599) expectOdometryIsTheTruth(outputs, 2e-3);
  }
  const Pose2 truth = toPose2(simulation.groundTruth().world_from_base);
  EXPECT_NEAR(truth.x_m, 0.0, 0.03);
  EXPECT_GT(truth.y_m, 1.5);
}

TEST(Omni, ItsCovarianceIsHonest) {
  OdometryParameters parameters;
  parameters.wheel_diameter_ratio = parameters.track_ratio = 1.0;
  parameters.track_ratio_tolerance = 0.0;
  const RobotDescription robot = shipped("omni");
  const auto rows = rimSpeedFromMotion(robot);
  constexpr int kRuns = 200;
  double sum = 0.0;
  for (int seed = 0; seed < kRuns; ++seed) {
    WheelOdometry odometry(robot, parameters, static_cast<std::uint64_t>(seed));
    OdometryReading reading = odometry.update(0, {});
    WheelValues angles = {};
    Pose2 truth;
    for (int i = 1; i <= 1000; ++i) {
      const Eigen::Vector3d motion(0.005, i < 500 ? 0.004 : -0.002, 0.003);
      for (std::size_t w = 0; w < 3; ++w)
        angles[w] += rows.row(static_cast<Eigen::Index>(w)).dot(motion) / robot.wheels[w].radius_m;
      const Eigen::Vector2d step = Eigen::Rotation2Dd(0.5 * motion.z()) * motion.head<2>();
      truth = truth * Pose2{step.x(), step.y(), motion.z()};
      reading = odometry.update(10'000'000LL * i, angles);
    }
    const Pose2& found = reading.odom_from_base;
    const Eigen::Vector3d error(found.x_m - truth.x_m, found.y_m - truth.y_m,
                                wrapAngle(found.yaw_rad - truth.yaw_rad));
    sum += error.dot(reading.covariance.ldlt().solve(error));
  }
  EXPECT_NEAR(sum / kRuns, 3.0, 3.0 * std::sqrt(6.0 / kRuns));
}

TEST(RobotDescription, FindsTheKindOfTheShippedBases) {
  EXPECT_EQ(shipped("ramscout").kind, BaseKind::kDifferential);
  EXPECT_EQ(shipped("car").kind, BaseKind::kAckermann);
  EXPECT_EQ(shipped("omni").kind, BaseKind::kOmnidirectional);
  EXPECT_NEAR(shipped("car").trackWidth_m(), 0.36, 1e-12);
  EXPECT_EQ(shipped("car").wheels[2].steering->joint, "left_steering_joint");
}

}  // namespace
}  // namespace ramscout_sim
