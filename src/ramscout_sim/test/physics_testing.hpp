// SPDX-License-Identifier: BSD-3-Clause
// A robot on an open floor, how it is driven, and its odometer.
#pragma once

#include <algorithm>
#include <cmath>

#include "ramscout_sim/physics.hpp"

#include "shared.hpp"

namespace ramscout_sim::testing {

constexpr double kStep_s = 1e-3;
constexpr double kGravity_mps2 = 9.81;
constexpr double kWheelRadius_m = 0.1;
constexpr double kTrack_m = 0.36;

/// Carried by its wheels alone; it does not tip because its weight hangs below the axle.
inline RobotDescription robotWithoutCasters() {
  RobotDescription robot = shippedRobot();
  robot.casters.clear();
  robot.chassis.center_in_base_m = {0.0, 0.0, 0.05};
  return robot;
}

inline double mass_kg(const RobotDescription& robot) {
  return robot.chassis.mass_kg + robot.wheels[0].mass.mass_kg + robot.wheels[1].mass.mass_kg;
}

inline Physics onOpenFloor(const RobotDescription& robot, double friction = 0.8) {
  World world;
  world.floor_friction = friction;
  return {robot, world, {}};
}

inline void run(Physics& physics, double duration_s, const WheelValues& speeds_radps) {
  const int steps = static_cast<int>(std::lround(duration_s / kStep_s));
  for (int i = 0; i < steps; ++i) physics.step(kStep_s, {speeds_radps, {}});
}

inline Pose2 poseOf(const Physics& physics) {
  return toPose2(physics.worldFromBase());
}

/// What the encoders of the nominal robot report, without noise, ticks or slip.
class Odometer {
public:
  explicit Odometer(const Physics& physics) : last_(physics.wheelAngles_rad()) {}

  void update(const Physics& physics) {
    const WheelValues now = physics.wheelAngles_rad();
    const double left_m = kWheelRadius_m * (now[0] - last_[0]);
    const double right_m = kWheelRadius_m * (now[1] - last_[1]);
    const double yaw_rad = (right_m - left_m) / kTrack_m;
    pose_ = pose_ * Pose2{0.5 * (left_m + right_m) * std::cos(0.5 * yaw_rad),
                          0.5 * (left_m + right_m) * std::sin(0.5 * yaw_rad), yaw_rad};
    distance_m_ += 0.5 * (left_m + right_m);
    turned_rad_ += yaw_rad;
    last_ = now;
  }
  const Pose2& pose() const { return pose_; }
  double distance_m() const { return distance_m_; }
  double turned_rad() const { return turned_rad_; }

private:
  WheelValues last_;
  Pose2 pose_;
  double distance_m_ = 0.0;
  double turned_rad_ = 0.0;
};

/// Drives `forward` (m) or turns `turn` (rad, on the spot), whichever is not 0, with gentle ramps;
/// as the odometer sees it.
inline void drive(Physics& physics, Odometer& odometer, double forward_m, double turn_rad) {
  const double wheel_way_m = forward_m != 0.0 ? forward_m : 0.5 * kTrack_m * turn_rad;
  constexpr double kCruise_mps = 0.5;
  constexpr double kAcceleration_mps2 = 0.5;
  const double way_m = std::abs(wheel_way_m);
  const double ramp_s =
      std::min(kCruise_mps / kAcceleration_mps2, std::sqrt(way_m / kAcceleration_mps2));
  const double top_mps = kAcceleration_mps2 * ramp_s;
  const double flat_s = way_m / top_mps - ramp_s;
  const double total_s = 2.0 * ramp_s + flat_s;
  const double settle_s = 0.2;
  for (double t = 0.5 * kStep_s; t < total_s + settle_s; t += kStep_s) {
    const double speed_mps = std::copysign(
        std::clamp(std::min(t, total_s - t) * kAcceleration_mps2, 0.0, top_mps), wheel_way_m);
    const double right_radps = speed_mps / kWheelRadius_m;
    physics.step(kStep_s, {{forward_m != 0.0 ? right_radps : -right_radps, right_radps}, {}});
    odometer.update(physics);
  }
}

}  // namespace ramscout_sim::testing
