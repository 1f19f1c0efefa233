// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

namespace ramscout_sim {
namespace {

double approach(double value, double target, double largest_change) {
  return value + std::clamp(target - value, -largest_change, largest_change);
}

}  // namespace

const ram_parameters::ParameterTable<DriveParameters>& DriveParameters::table() {
  using namespace ram_parameters;
  using P = DriveParameters;
  static const auto table =
      ParameterTable<P>()
          .add("max_speed_mps", &P::max_speed_mps, "m/s", positive(),
               "Fastest that the motors are asked for; the torque limit is in the URDF (<limit "
               "effort>).")
          .add("max_turn_speed_radps", &P::max_turn_speed_radps, "rad/s", positive(),
               "Fastest turn that the motors are asked for.")
          .add("max_acceleration_mps2", &P::max_acceleration_mps2, "m/s^2", positive(),
               "Fastest change of the speed.")
          .add("max_turn_acceleration_radps2", &P::max_turn_acceleration_radps2, "rad/s^2",
               positive(), "Fastest change of the turn speed.")
          .add("command_timeout_s", &P::command_timeout_s, "s", positive(),
               "Simulated time after which a command counts as zero.")
          .expert("Steering")
          .add("standing_speed_mps", &P::standing_speed_mps, "m/s", positive(),
               "Slower commands leave the steering of a car as it is.");
  return table;
}

Eigen::Matrix<double, Eigen::Dynamic, 3> rimSpeedFromMotion(const RobotDescription& robot) {
  const auto count = static_cast<Eigen::Index>(robot.wheels.size());
  Eigen::Matrix<double, Eigen::Dynamic, 3> rows =
      Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Wheel& wheel = robot.wheels[static_cast<std::size_t>(i)];
    if (wheel.steering) continue;
    const Eigen::Vector3d rolling = wheel.axle_in_base.cross(Eigen::Vector3d::UnitZ());
    rows.row(i) << rolling.x(), rolling.y(), wheel.center_in_base_m.cross(rolling).z();
  }
  return rows;
}

Eigen::Matrix<double, 3, Eigen::Dynamic> motionFromRimSpeed(const RobotDescription& robot) {
  return Eigen::MatrixXd(rimSpeedFromMotion(robot))
      .completeOrthogonalDecomposition()
      .pseudoInverse();
}

Drive::Drive(const RobotDescription& robot, const DriveParameters& limits)
    : robot_(robot),
      limits_((limits.validate(), limits)),
      rim_speed_from_motion_(rimSpeedFromMotion(robot)) {
  if (robot.kind != BaseKind::kAckermann) return;
  max_curvature_per_m_ = max_steering_speed_radps_ = std::numeric_limits<double>::infinity();
  for (const Wheel& wheel : robot.wheels) {
    if (!wheel.steering) continue;
    const double tangent = std::tan(wheel.steering->max_angle_rad);
    const double x_m = wheel.center_in_base_m.x();
    const double y_m = std::abs(wheel.center_in_base_m.y());
    wheelbase_m_ = x_m;
    max_curvature_per_m_ =
        std::min(max_curvature_per_m_, tangent / (std::abs(x_m) + y_m * tangent));
    max_steering_speed_radps_ =
        std::min(max_steering_speed_radps_, wheel.steering->max_speed_radps);
  }
}

Twist2 Drive::clamped(const Twist2& wanted) const {
  Twist2 twist = wanted;
  if (robot_.kind != BaseKind::kOmnidirectional) twist.left_mps = 0.0;
  const double speed_mps = std::hypot(twist.forward_mps, twist.left_mps);
  if (speed_mps > limits_.max_speed_mps) {
    twist.forward_mps *= limits_.max_speed_mps / speed_mps;
    twist.left_mps *= limits_.max_speed_mps / speed_mps;
  }
  twist.turn_radps =
      std::clamp(twist.turn_radps, -limits_.max_turn_speed_radps, limits_.max_turn_speed_radps);
  return twist;
}

WheelMotion Drive::advance(const Twist2& wanted, double duration_s) {
  const Twist2 target = clamped(wanted);
  const double change_mps = limits_.max_acceleration_mps2 * duration_s;
  setpoint_.forward_mps = approach(setpoint_.forward_mps, target.forward_mps, change_mps);
  setpoint_.left_mps = approach(setpoint_.left_mps, target.left_mps, change_mps);
  setpoint_.turn_radps = approach(setpoint_.turn_radps, target.turn_radps,
                                  limits_.max_turn_acceleration_radps2 * duration_s);
  if (robot_.kind == BaseKind::kAckermann) {
    steer(target, duration_s);
    return carMotion();
  }
  const Eigen::Vector3d motion(setpoint_.forward_mps, setpoint_.left_mps, setpoint_.turn_radps);
  WheelMotion wheels;
  for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
    wheels.speeds_radps[i] = rim_speed_from_motion_.row(static_cast<Eigen::Index>(i)).dot(motion) /
                             robot_.wheels[i].radius_m;
  }
  return wheels;
}

void Drive::steer(const Twist2& wanted, double duration_s) {
  if (std::abs(wanted.forward_mps) < limits_.standing_speed_mps) return;
  const double curvature_per_m = std::clamp(wanted.turn_radps / wanted.forward_mps,
                                            -max_curvature_per_m_, max_curvature_per_m_);
  steering_rad_ = approach(steering_rad_, std::atan(curvature_per_m * wheelbase_m_),
                           max_steering_speed_radps_ * duration_s);
}

/// All wheels roll about one point on the line of the axle that is not steered.
WheelMotion Drive::carMotion() const {
  const double curvature_per_m = std::tan(steering_rad_) / wheelbase_m_;
  WheelMotion wheels;
  for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
    const Wheel& wheel = robot_.wheels[i];
    const double along = 1.0 - curvature_per_m * wheel.center_in_base_m.y();
    const double across = curvature_per_m * wheel.center_in_base_m.x();
    const double rim = wheel.steering ? std::hypot(along, across) : along;
    wheels.speeds_radps[i] = setpoint_.forward_mps * rim / wheel.radius_m;
    if (wheel.steering) wheels.steering_rad[i] = std::atan2(across, along);
  }
  return wheels;
}

}  // namespace ramscout_sim
