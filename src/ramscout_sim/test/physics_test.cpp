// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/physics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>

#include "ramscout_sim/wheel_odometry.hpp"

#include "physics_testing.hpp"

namespace ramscout_sim {
namespace {

using testing::drive;
using testing::kGravity_mps2;
using testing::kStep_s;
using testing::kTrack_m;
using testing::kWheelRadius_m;
using testing::mass_kg;
using testing::Odometer;
using testing::onOpenFloor;
using testing::poseOf;
using testing::robotWithoutCasters;
using testing::run;
using testing::shippedRobot;

TEST(Physics, AFreeBodyFallsByTheDiscreteFormula) {
  RobotDescription robot = shippedRobot();
  robot.casters.clear();
  for (Wheel* wheel : {&robot.wheels[0], &robot.wheels[1]}) {
    wheel->center_in_base_m.z() = 100.0;
    wheel->mass.center_in_base_m.z() = 100.0;
  }
  robot.chassis.center_in_base_m.z() = 100.0;
  for (Solid& shape : robot.chassis_shapes)
    shape.world_from_solid.pretranslate(Eigen::Vector3d(0, 0, 100));
  Physics physics = onOpenFloor(robot);
  run(physics, 1.0, {});
  // Semi-implicit Euler: velocity first, then position with the new velocity.
  EXPECT_NEAR(physics.worldFromBase().translation().z(),
              -kGravity_mps2 * 1.0 * (1.0 + kStep_s) / 2.0, 1e-9);
  EXPECT_NEAR(physics.linearVelocity_mps().z(), -kGravity_mps2, 1e-9);
}

TEST(Physics, TheFloorCarriesTheWholeWeight) {
  const RobotDescription robot = robotWithoutCasters();
  Physics physics = onOpenFloor(robot);
  run(physics, 5.0, {});
  const WheelValues loads = physics.wheelLoads_n();
  EXPECT_NEAR(loads[0] + loads[1], kGravity_mps2 * mass_kg(robot), 1e-6);
  EXPECT_NEAR(loads[0], loads[1], 1e-6);
}

TEST(Physics, ItSinksByLoadTimesSoftnessOfTheFloor) {
  const RobotDescription robot = robotWithoutCasters();
  Physics physics = onOpenFloor(robot);
  run(physics, 5.0, {});
  constexpr double kSoftness = 1e-6;
  constexpr double kErrorReduction = 0.2;
  const double expected_m = physics.wheelLoads_n()[0] * kStep_s * kSoftness / kErrorReduction;
  EXPECT_NEAR(physics.worldFromBase().translation().z() / -expected_m, 1.0, 1e-6);
}

TEST(Physics, AnOffCentreWeightLoadsTheWheelsByTheLever) {
  RobotDescription robot = robotWithoutCasters();
  constexpr double kOffset_m = 0.06;
  robot.chassis.center_in_base_m.y() = kOffset_m;
  Physics physics = onOpenFloor(robot);
  run(physics, 5.0, {});
  const WheelValues loads = physics.wheelLoads_n();
  EXPECT_NEAR(loads[0] - loads[1],
              2.0 * kGravity_mps2 * robot.chassis.mass_kg * kOffset_m / kTrack_m, 1e-3);
}

TEST(Physics, APayloadWeighsWhereItLiesAndComesOffAgain) {
  const RobotDescription robot = robotWithoutCasters();
  Physics physics = onOpenFloor(robot);
  run(physics, 1.0, {});
  const WheelValues before_n = physics.wheelLoads_n();
  const Eigen::Isometry3d pose = physics.worldFromBase();
  MassProperties payload;
  payload.mass_kg = 4.0;
  payload.center_in_base_m = {0.0, 0.09, 0.02};  // half way to the left wheel, below the axle
  payload.inertia_kgm2 = 0.01 * Eigen::Matrix3d::Identity();
  physics.setPayload(payload);
  EXPECT_TRUE(physics.worldFromBase().isApprox(pose, 1e-12));
  run(physics, 1.0, {});
  const double weight_n = 4.0 * kGravity_mps2;
  EXPECT_NEAR(physics.wheelLoads_n()[0] - before_n[0], 0.75 * weight_n, 1e-3 * weight_n);
  EXPECT_NEAR(physics.wheelLoads_n()[1] - before_n[1], 0.25 * weight_n, 1e-3 * weight_n);
  physics.setPayload({});
  run(physics, 1.0, {});
  EXPECT_NEAR(physics.wheelLoads_n()[0], before_n[0], 1e-3 * weight_n);
  EXPECT_THROW(physics.setPayload({-1.0, {}, {}}), std::invalid_argument);
}

TEST(Physics, APayloadSlowsWhatTheMotorsTorqueAccelerates) {
  RobotDescription robot = shippedRobot();
  for (Wheel& wheel : robot.wheels) wheel.max_torque_nm = 0.5;
  MassProperties payload;
  payload.mass_kg = 20.0;
  payload.center_in_base_m = {0.0, 0.0, 0.05};
  payload.inertia_kgm2 = 0.1 * Eigen::Matrix3d::Identity();
  Physics physics = onOpenFloor(robot);
  physics.setPayload(payload);
  run(physics, 0.5, {});
  const double begin_mps = physics.linearVelocity_mps().x();
  run(physics, 0.5, {100.0, 100.0});
  const double inertia_kg =
      2.0 * 0.005 / (kWheelRadius_m * kWheelRadius_m);  // of the spinning wheels, at the rim
  const double expected_mps2 = 2.0 * 0.5 / kWheelRadius_m / (mass_kg(robot) + 20.0 + inertia_kg);
  EXPECT_NEAR((physics.linearVelocity_mps().x() - begin_mps) / 0.5, expected_mps2,
              0.01 * expected_mps2);
}

/// A ramp that begins at x = 1 m, and a platform behind it.
World rampWorld(double length_m, double height_m) {
  World world;
  world.solids = {makeRamp({1.0, 0.0}, {1.0 + length_m, 0.0}, 2.0, height_m)};
  Solid platform;
  platform.drivable = true;
  platform.size_m = {4.0, 2.0, height_m};
  platform.world_from_solid.translate(Eigen::Vector3d(1.0 + length_m + 2.0, 0.0, 0.5 * height_m));
  world.solids.push_back(platform);
  return world;
}

/// At the foot the casters, on the floor and on the ramp, lift the wheels: it takes a run-up.
constexpr double kRunUp_radps = 12.0;

TEST(Physics, ItClimbsARampAndComesDownAgain) {
  constexpr double kHeight_m = 0.2;
  constexpr double kLength_m = 2.0;
  Physics physics(shippedRobot(), rampWorld(kLength_m, kHeight_m), {});
  const double slope_rad = std::atan2(kHeight_m, kLength_m);
  double steepest_rad = 0.0;
  for (int i = 0; i < 10000 && poseOf(physics).x_m < 4.5; ++i) {
    physics.step(kStep_s, {{kRunUp_radps, kRunUp_radps}, {}});
    const double x_m = poseOf(physics).x_m;
    if (x_m < 1.5 || x_m > 2.5) continue;  // with every wheel and caster on the ramp
    const Eigen::Isometry3d pose = physics.worldFromBase();
    EXPECT_NEAR(pose.translation().z(), (x_m - 1.0) * std::tan(slope_rad), 2e-3);
    steepest_rad = std::max(steepest_rad, std::asin(pose.linear()(2, 0)));
  }
  EXPECT_NEAR(steepest_rad, slope_rad, 0.01);
  EXPECT_GT(poseOf(physics).x_m, 4.4);
  EXPECT_NEAR(physics.worldFromBase().translation().z(), kHeight_m, 1e-3);
  for (int i = 0; i < 15000 && poseOf(physics).x_m > 0.0; ++i)
    physics.step(kStep_s, {{-kRunUp_radps, -kRunUp_radps}, {}});
  run(physics, 0.5, {});
  EXPECT_LT(poseOf(physics).x_m, 0.1);
  EXPECT_NEAR(physics.worldFromBase().translation().z(), 0.0, 1e-3);
}

TEST(Physics, OnARampItHoldsByItsBrakesAndSlidesWhereItIsTooSmooth) {
  for (const double friction : {0.5, 0.02}) {
    World world = rampWorld(4.0, 0.4);
    Physics physics(shippedRobot(), world, {});
    for (int i = 0; i < 10000 && poseOf(physics).x_m < 3.0; ++i)
      physics.step(kStep_s, {{kRunUp_radps, kRunUp_radps}, {}});
    run(physics, 1.0, {});
    const double stopped_m = poseOf(physics).x_m;
    ASSERT_GT(stopped_m, 2.5);
    physics.setFloorFriction(friction);
    run(physics, 1.0, {});
    if (friction > 0.1)
      EXPECT_NEAR(poseOf(physics).x_m, stopped_m, 1e-5);
    else
      EXPECT_LT(poseOf(physics).x_m, stopped_m - 0.2);
  }
}

TEST(Physics, TheMotorsTorqueLimitsTheAcceleration) {
  RobotDescription robot = shippedRobot();
  robot.wheels[0].max_torque_nm = robot.wheels[1].max_torque_nm = 0.5;
  Physics physics = onOpenFloor(robot);
  run(physics, 1.0, {});
  const double before_mps = physics.linearVelocity_mps().x();
  run(physics, 1.0, {1000.0, 1000.0});
  const double after_mps = physics.linearVelocity_mps().x();
  const double wheel_inertia_kgm2 = robot.wheels[0].mass.inertia_kgm2(1, 1);
  const double rolling_mass_kg =
      mass_kg(robot) + 2.0 * wheel_inertia_kgm2 / (kWheelRadius_m * kWheelRadius_m);
  const double expected_mps2 = 2.0 * 0.5 / kWheelRadius_m / rolling_mass_kg;
  EXPECT_NEAR((after_mps - before_mps) / expected_mps2, 1.0, 1e-4);
}

TEST(Physics, FrictionLimitsTheAccelerationToTheLoadOfTheWheels) {
  for (const double friction : {0.05, 0.1, 0.2}) {
    const RobotDescription robot = shippedRobot();
    Physics physics = onOpenFloor(robot, friction);
    run(physics, 1.0, {});
    constexpr WheelValues kSpinning{40.0, 40.0};
    run(physics, 0.3, kSpinning);
    const double begin_mps = physics.linearVelocity_mps().x();
    double impulse_ns = 0.0;
    for (int i = 0; i < 200; ++i) {
      // The limit follows the load of the step before.
      impulse_ns += friction * (physics.wheelLoads_n()[0] + physics.wheelLoads_n()[1]) * kStep_s;
      physics.step(kStep_s, {kSpinning, {}});
    }
    const double gained_mps = physics.linearVelocity_mps().x() - begin_mps;
    EXPECT_NEAR(gained_mps * mass_kg(robot) / impulse_ns, 1.0, 1e-3) << friction;
  }
}

TEST(Physics, TheBrakesStopOnTheDistanceOfTheirTorque) {
  const RobotDescription robot = shippedRobot();
  Physics physics = onOpenFloor(robot, 2.0);
  run(physics, 0.5, {});
  for (int i = 0; i < 2000; ++i) {
    const double speed_radps = 10.0 * std::min(1.0, i / 1000.0);
    physics.step(kStep_s, {{speed_radps, speed_radps}, {}});
  }
  const double speed_mps = physics.linearVelocity_mps().x();
  ASSERT_NEAR(speed_mps, 1.0, 1e-3);
  const double begin_m = poseOf(physics).x_m;
  run(physics, 2.0, {});
  const double wheel_inertia_kgm2 = robot.wheels[0].mass.inertia_kgm2(1, 1);
  const double rolling_mass_kg =
      mass_kg(robot) + 2.0 * wheel_inertia_kgm2 / (kWheelRadius_m * kWheelRadius_m);
  const double deceleration_mps2 =
      2.0 * robot.wheels[0].max_torque_nm / kWheelRadius_m / rolling_mass_kg;
  const double expected_m = speed_mps * speed_mps / (2.0 * deceleration_mps2);
  EXPECT_NEAR(poseOf(physics).x_m - begin_m, expected_m - 0.5 * speed_mps * kStep_s,
              0.005 * expected_m);
}

TEST(Physics, WithoutFrictionTheWheelsSpinAndTheRobotStays) {
  Physics physics = onOpenFloor(shippedRobot(), 0.0);
  run(physics, 1.0, {10.0, 10.0});
  EXPECT_NEAR(poseOf(physics).x_m, 0.0, 1e-9);
  EXPECT_GT(physics.wheelAngles_rad()[0], 8.0);
}

TEST(Physics, TenMetresStraightAreTenMetresOfWheel) {
  Physics physics = onOpenFloor(shippedRobot());
  Odometer odometer(physics);
  drive(physics, odometer, 10.0, 0.0);
  EXPECT_NEAR(odometer.distance_m(), 10.0, 0.01);
  EXPECT_NEAR(poseOf(physics).x_m / odometer.distance_m(), 1.0, 1e-4);
  EXPECT_NEAR(poseOf(physics).y_m, 0.0, 1e-6);
  EXPECT_NEAR(poseOf(physics).yaw_rad, 0.0, 1e-6);
}

TEST(Physics, ASquareOfFiveMetresEndsWhereTheOdometryDoes) {
  Physics physics = onOpenFloor(shippedRobot());
  Odometer odometer(physics);
  for (int side = 0; side < 4; ++side) {
    drive(physics, odometer, 5.0, 0.0);
    drive(physics, odometer, 0.0, M_PI_2);
  }
  const Pose2 truth = poseOf(physics);
  EXPECT_NEAR(odometer.turned_rad(), 2.0 * M_PI, 0.01);
  EXPECT_NEAR(std::hypot(truth.x_m - odometer.pose().x_m, truth.y_m - odometer.pose().y_m), 0.0,
              1e-3);
  EXPECT_NEAR(wrapAngle(truth.yaw_rad - odometer.pose().yaw_rad), 0.0, 1e-4);
}

TEST(Physics, TenTurnsOnTheSpotAreTenTurnsOfTheWheels) {
  Physics physics = onOpenFloor(shippedRobot());
  Odometer odometer(physics);
  double turned_rad = 0.0;
  double last_rad = 0.0;
  for (int turn = 0; turn < 40; ++turn) {
    drive(physics, odometer, 0.0, M_PI_2);
    turned_rad += wrapAngle(poseOf(physics).yaw_rad - last_rad);
    last_rad = poseOf(physics).yaw_rad;
  }
  ASSERT_NEAR(odometer.turned_rad(), 20.0 * M_PI, 0.1);
  EXPECT_NEAR(turned_rad / odometer.turned_rad(), 1.0, 1e-5);
  EXPECT_NEAR(std::hypot(poseOf(physics).x_m, poseOf(physics).y_m), 0.0, 1e-3);
}

TEST(Physics, ACircleHasTheDiameterOfTheWheelSpeeds) {
  Physics physics = onOpenFloor(shippedRobot());
  for (int i = 0; i < 1000; ++i) physics.step(kStep_s, {{4.0e-3 * i, 6.0e-3 * i}, {}});
  run(physics, 1.0, {4.0, 6.0});
  const Pose2 begin = poseOf(physics);
  double farthest_m = 0.0;
  for (int i = 0; i < 12000; ++i) {
    physics.step(kStep_s, {{4.0, 6.0}, {}});
    const Pose2 now = poseOf(physics);
    farthest_m = std::max(farthest_m, std::hypot(now.x_m - begin.x_m, now.y_m - begin.y_m));
  }
  const double radius_m = 0.5 * kTrack_m * (6.0 + 4.0) / (6.0 - 4.0);
  EXPECT_NEAR(farthest_m / (2.0 * radius_m), 1.0, 1e-5);
}

/// Where a 4 m square ends that the odometry takes for closed (UMBmark, Borenstein and Feng 1996).
Pose2 driveSquare(const RobotDescription& robot, double turn_rad) {
  Physics physics = onOpenFloor(robot);
  Odometer odometer(physics);
  for (int side = 0; side < 4; ++side) {
    // Corrects what is left of the last leg, so that the nominal square is closed.
    drive(physics, odometer, 4.0, 0.0);
    drive(physics, odometer, 0.0, turn_rad * (side + 1) - odometer.turned_rad());
  }
  const Pose2 world_from_base = poseOf(physics);
  return {world_from_base.x_m - odometer.pose().x_m, world_from_base.y_m - odometer.pose().y_m,
          wrapAngle(world_from_base.yaw_rad - odometer.pose().yaw_rad)};
}

TEST(Physics, UmbmarkRecoversUnequalWheelsAndAWrongTrack) {
  struct Errors {
    double diameter_ratio, track_ratio;
  };
  for (const Errors& injected :
       {Errors{1.002, 1.0}, Errors{1.0, 1.01}, Errors{1.003, 0.995}, Errors{0.9975, 1.004}}) {
    OdometryParameters parameters;
    parameters.wheel_diameter_ratio = injected.diameter_ratio;
    parameters.track_ratio = injected.track_ratio;
    const RobotDescription robot = withTrueGeometry(shippedRobot(), parameters);
    const Pose2 left = driveSquare(robot, M_PI_2);
    const Pose2 right = driveSquare(robot, -M_PI_2);
    constexpr double kSide_m = 4.0;
    // Means of the estimates from the errors in x and in y.
    const double alpha_rad = (right.x_m + left.x_m + right.y_m - left.y_m) / (-8.0 * kSide_m);
    const double beta_rad = (right.x_m - left.x_m + right.y_m + left.y_m) / (-8.0 * kSide_m);
    const double radius_m = 0.5 * kSide_m / std::sin(0.5 * beta_rad);
    const double diameter_ratio = (radius_m + 0.5 * kTrack_m) / (radius_m - 0.5 * kTrack_m);
    const double track_ratio = M_PI_2 / (M_PI_2 - alpha_rad);
    EXPECT_NEAR(diameter_ratio, injected.diameter_ratio, 1e-4);
    EXPECT_NEAR(track_ratio, injected.track_ratio, 1e-3);
  }
}

}  // namespace
}  // namespace ramscout_sim
