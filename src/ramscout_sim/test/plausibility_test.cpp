// SPDX-License-Identifier: BSD-3-Clause
// Closed formulas of a car with four wheels, which carry it alone.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "ramscout_sim/physics.hpp"

#include "shared.hpp"

namespace ramscout_sim {
namespace {

constexpr double kStep_s = 1e-3;
constexpr double kGravity_mps2 = 9.81;
constexpr double kRadius_m = 0.1;
constexpr double kWheelbase_m = 0.4;
constexpr std::array<std::size_t, 2> kRear = {0, 1};
constexpr std::array<std::size_t, 2> kFront = {2, 3};

RobotDescription car() {
  return readRobot(std::string(CONFIG_FOLDER) + "/robots/car.urdf");
}

/// With motors on all wheels; 0 makes all of them roll freely.
RobotDescription carWithTorque(double torque_nm) {
  RobotDescription robot = car();
  for (Wheel& wheel : robot.wheels) wheel.max_torque_nm = torque_nm;
  return robot;
}

RobotDescription withWheelInertia(RobotDescription robot, double inertia_kgm2) {
  for (Wheel& wheel : robot.wheels)
    wheel.mass.inertia_kgm2 = inertia_kgm2 * Eigen::Matrix3d::Identity();
  return robot;
}

/// On a floor that falls towards +x by `slope_rad`.
Physics onSlope(const RobotDescription& robot, double friction, double slope_rad) {
  World world;
  world.floor_friction = friction;
  world.gravity_mps2 =
      kGravity_mps2 * Eigen::Vector3d(std::sin(slope_rad), 0.0, -std::cos(slope_rad));
  return {robot, world, {}};
}

void run(Physics& physics, double duration_s, double speed_mps) {
  const double radps = speed_mps / kRadius_m;
  for (int i = 0; i < std::lround(duration_s / kStep_s); ++i)
    physics.step(kStep_s, {{radps, radps, radps, radps}, {}});
}

/// Brings all wheels to that speed at 1 m/s^2.
void accelerate(Physics& physics, double speed_mps) {
  for (int i = 1; i <= std::lround(speed_mps / kStep_s); ++i) run(physics, kStep_s, i * kStep_s);
  run(physics, 0.2, speed_mps);
}

double speed_mps(const Physics& physics) {
  return physics.linearVelocity_mps().x();
}

double x_m(const Physics& physics) {
  return physics.worldFromBase().translation().x();
}

/// Mean over the next second, with the wheels commanded to run at that speed.
double acceleration_mps2(Physics& physics, double wheels_mps) {
  const double before_mps = speed_mps(physics);
  run(physics, 1.0, wheels_mps);
  return speed_mps(physics) - before_mps;
}

double load_n(const Physics& physics, const std::array<std::size_t, 2>& axle) {
  const WheelValues loads = physics.wheelLoads_n();
  return loads[axle[0]] + loads[axle[1]];
}

TEST(Plausibility, AxlesCarryWhatTheLeverSays) {
  const MassProperties whole = combined(car());
  Physics physics = onSlope(car(), 0.8, 0.0);
  run(physics, 3.0, 0.0);
  const double weight_n = whole.mass_kg * kGravity_mps2;
  EXPECT_NEAR((load_n(physics, kRear) + load_n(physics, kFront)) / weight_n, 1.0, 1e-9);
  const double expected_n = weight_n * whole.center_in_base_m.x() / kWheelbase_m;
  EXPECT_NEAR(load_n(physics, kFront) / expected_n, 1.0, 1e-5);
}

TEST(Plausibility, WeightMovesToTheRearAxleWhileItAccelerates) {
  const RobotDescription robot = car();
  const MassProperties whole = combined(robot);
  Physics physics = onSlope(robot, 0.8, 0.0);
  run(physics, 1.0, 0.0);
  const double still_n = load_n(physics, kRear);
  constexpr double kAcceleration_mps2 = 1.0;
  for (int i = 1; i <= 1000; ++i) run(physics, kStep_s, kAcceleration_mps2 * i * kStep_s);
  double spin_nm = 0.0;
  for (const Wheel& wheel : robot.wheels)
    spin_nm += wheel.mass.inertia_kgm2(1, 1) * kAcceleration_mps2 / kRadius_m;
  const double expected_n =
      (whole.mass_kg * kAcceleration_mps2 * whole.center_in_base_m.z() + spin_nm) / kWheelbase_m;
  EXPECT_NEAR((load_n(physics, kRear) - still_n) / expected_n, 1.0, 1e-4);
}

TEST(Plausibility, LockedWheelsStopOnTheDistanceOfCoulombFriction) {
  for (const double friction : {0.2, 0.5}) {
    Physics physics = onSlope(carWithTorque(1e4), friction, 0.0);
    run(physics, 0.5, 0.0);
    accelerate(physics, 1.5);
    const double begin_m = x_m(physics);
    const double begin_mps = speed_mps(physics);
    run(physics, 3.0, 0.0);
    const double expected_m = begin_mps * begin_mps / (2.0 * friction * kGravity_mps2);
    // The integrator's own error: the first step is already slower.
    EXPECT_NEAR(x_m(physics) - begin_m, expected_m - 0.5 * begin_mps * kStep_s, 0.005 * expected_m);
    EXPECT_NEAR(speed_mps(physics), 0.0, 1e-6);
  }
}

TEST(Plausibility, SlopesUpToTheAngleOfFrictionHoldLockedWheels) {
  constexpr double kFriction = 0.4;
  for (const double share : {0.99, 1.01}) {
    const double slope_rad = share * std::atan(kFriction);
    Physics physics = onSlope(carWithTorque(1e4), kFriction, slope_rad);
    run(physics, 0.5, 0.0);
    const double before_mps = speed_mps(physics);
    const double gained_mps = acceleration_mps2(physics, 0.0);
    if (share < 1.0) {
      EXPECT_NEAR(before_mps, 0.0, 1e-6);
      EXPECT_NEAR(gained_mps, 0.0, 1e-6);
    } else {
      const double expected_mps2 =
          kGravity_mps2 * (std::sin(slope_rad) - kFriction * std::cos(slope_rad));
      EXPECT_NEAR(gained_mps / expected_mps2, 1.0, 1e-3);
    }
  }
}

TEST(Plausibility, FreeWheelsRollDownASlopeLikeBalls) {
  constexpr double kSlope_rad = 0.1;
  RobotDescription robot = carWithTorque(0.0);
  // As much inertia in the wheels as balls of the car's mass and the wheels' radius would have.
  robot = withWheelInertia(robot, 0.4 * combined(robot).mass_kg * kRadius_m * kRadius_m / 4.0);
  Physics physics = onSlope(robot, 0.8, kSlope_rad);
  run(physics, 0.5, 0.0);
  const double gained_mps = acceleration_mps2(physics, 0.0);
  EXPECT_NEAR(gained_mps / (5.0 / 7.0 * kGravity_mps2 * std::sin(kSlope_rad)), 1.0, 1e-6);
}

TEST(Plausibility, SpinningWheelsAccelerateByTheirLoad) {
  for (const double friction : {0.2, 0.4}) {
    Physics physics = onSlope(carWithTorque(8.0), friction, 0.0);
    run(physics, 0.5, 0.0);
    run(physics, 1.0, 20.0);
    ASSERT_NEAR(physics.wheelSpeeds_radps()[0], 200.0, 1e-9);  // from now on at constant speed
    EXPECT_NEAR(acceleration_mps2(physics, 20.0) / (friction * kGravity_mps2), 1.0, 1e-3);
  }
}

TEST(Plausibility, ARearWheelDriveGainsTractionFromItsAcceleration) {
  constexpr double kFriction = 0.4;
  RobotDescription robot = withWheelInertia(car(), 1e-6);
  for (const std::size_t wheel : kRear) robot.wheels[wheel].max_torque_nm = 1e4;
  const MassProperties whole = combined(robot);
  Physics physics = onSlope(robot, kFriction, 0.0);
  run(physics, 0.5, 0.0);
  run(physics, 0.2, 50.0);
  const double expected_mps2 = kFriction * kGravity_mps2 *
                               (kWheelbase_m - whole.center_in_base_m.x()) /
                               (kWheelbase_m - kFriction * whole.center_in_base_m.z());
  EXPECT_NEAR(acceleration_mps2(physics, 50.0) / expected_mps2, 1.0, 1e-3);
}

TEST(Plausibility, TorqueAcceleratesTheCarAndItsWheels) {
  constexpr double kTorque_nm = 0.5;
  const RobotDescription robot = carWithTorque(kTorque_nm);
  Physics physics = onSlope(robot, 0.8, 0.0);
  run(physics, 0.5, 0.0);
  run(physics, 0.2, 50.0);
  const double inertia_kgm2 = robot.wheels[0].mass.inertia_kgm2(1, 1);
  const double rolling_mass_kg =
      combined(robot).mass_kg + 4.0 * inertia_kgm2 / (kRadius_m * kRadius_m);
  EXPECT_NEAR(acceleration_mps2(physics, 50.0) / (4.0 * kTorque_nm / kRadius_m / rolling_mass_kg),
              1.0, 1e-6);
}

TEST(Plausibility, BrakesHoldOnASlope) {
  Physics physics = onSlope(car(), 0.8, 0.1);
  run(physics, 2.0, 0.0);
  const double begin_m = x_m(physics);
  run(physics, 10.0, 0.0);
  EXPECT_NEAR(x_m(physics), begin_m, 1e-6 * 10.0);
}

TEST(Plausibility, ItTipsWhenFrictionTimesHeightExceedsTheLever) {
  for (const double share : {0.98, 1.02}) {
    // Light wheels: stopping them in a step would throw the chassis forward.
    RobotDescription robot = withWheelInertia(carWithTorque(1e4), 1e-6);
    robot.chassis.center_in_base_m.z() = 0.6;
    const MassProperties whole = combined(robot);
    const double lever_m = kWheelbase_m - whole.center_in_base_m.x();
    Physics physics = onSlope(robot, share * lever_m / whole.center_in_base_m.z(), 0.0);
    run(physics, 1.0, 0.0);
    accelerate(physics, 1.5);
    double lightest_n = load_n(physics, kRear);
    while (speed_mps(physics) > 0.1) {
      run(physics, kStep_s, 0.0);
      lightest_n = std::min(lightest_n, load_n(physics, kRear));
    }
    if (share < 1.0) {
      EXPECT_GT(lightest_n, 0.0);
    } else {
      EXPECT_EQ(lightest_n, 0.0);
    }
  }
}

TEST(Plausibility, NothingSpeedsUpByItself) {
  const RobotDescription robot = carWithTorque(0.0);
  Physics physics = onSlope(robot, 0.8, 0.0);
  run(physics, 1.0, 0.0);
  for (int i = 0; i < 20000; ++i) {
    run(physics, kStep_s, 0.0);
    ASSERT_LT(physics.linearVelocity_mps().norm() + physics.angularVelocity_radps().norm(), 1e-9);
  }
  // Nor while it coasts.
  RobotDescription driven = carWithTorque(5.0);
  Physics coasting = onSlope(driven, 0.8, 0.0);
  accelerate(coasting, 1.0);
  double fastest_mps = speed_mps(coasting);
  for (int i = 0; i < 5000; ++i) {
    run(coasting, kStep_s, 1.0);
    ASSERT_LT(speed_mps(coasting), fastest_mps + 1e-9);
  }
}

TEST(Plausibility, SlipperyFloorMakesWheelsSlipUntilItIsDry) {
  Physics physics = onSlope(carWithTorque(5.0), 0.8, 0.0);
  accelerate(physics, 1.0);
  physics.setFloorFriction(0.01);
  const double wheel_before_rad = physics.wheelAngles_rad()[0];
  const double before_m = x_m(physics);
  run(physics, 0.5, 0.0);
  EXPECT_GT(x_m(physics) - before_m, 0.4);  // it slides on
  EXPECT_LT(kRadius_m * (physics.wheelAngles_rad()[0] - wheel_before_rad), 0.1);
  physics.setFloorFriction(0.8);
  run(physics, 0.5, 0.0);
  EXPECT_NEAR(speed_mps(physics), 0.0, 1e-6);
  EXPECT_THROW(physics.setFloorFriction(-1.0), std::invalid_argument);
}

}  // namespace
}  // namespace ramscout_sim
