// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/pose2.hpp"
#include "ramscout_sim/robot_description.hpp"

namespace ramscout_sim {

/// Limits of what the motors are asked for.
struct DriveParameters {
  double max_speed_mps = 1.5;
  double max_turn_speed_radps = 3.0;
  double max_acceleration_mps2 = 1.0;
  double max_turn_acceleration_radps2 = 4.0;
  /// A command older than this counts as zero.
  double command_timeout_s = 0.5;
  /// Slower commands leave the steering of a car as it is.
  double standing_speed_mps = 1e-3;

  static const ram_parameters::ParameterTable<DriveParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// One row per wheel: how fast its rim runs for a motion (forward, left, turn) of the base. The
/// rows of steered wheels are zero.
Eigen::Matrix<double, Eigen::Dynamic, 3> rimSpeedFromMotion(const RobotDescription& robot);

/// The other way round, by least squares; what the wheels do not determine is zero. (3 x wheels)
Eigen::Matrix<double, 3, Eigen::Dynamic> motionFromRimSpeed(const RobotDescription& robot);

/// Turns commands into what wheels and steering shall do, within the drive's limits.
class Drive {
public:
  Drive(const RobotDescription& robot, const DriveParameters& limits);

  /// The setpoint `duration_s` later. A base without omni wheels ignores the speed to the left; a
  /// car keeps the curvature turn / forward within what its steering can do, and its wheels as they
  /// are when the command is to stand.
  WheelMotion advance(const Twist2& wanted, double duration_s);

  /// The setpoint is zero at once; steering stays.
  void stop() { setpoint_ = {}; }

private:
  Twist2 clamped(const Twist2& wanted) const;
  void steer(const Twist2& wanted, double duration_s);
  WheelMotion carMotion() const;

  RobotDescription robot_;
  DriveParameters limits_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> rim_speed_from_motion_;
  Twist2 setpoint_;
  // Of a car: what its steering can do, and the angle of a wheel in the middle of the steered axle.
  double wheelbase_m_ = 0.0;
  double max_curvature_per_m_ = 0.0;
  double max_steering_speed_radps_ = 0.0;
  double steering_rad_ = 0.0;
};

}  // namespace ramscout_sim
