// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/pose2.hpp"
#include "ramscout_sim/robot_description.hpp"

namespace ramscout_sim {

/// How the robot that drives differs from the robot that its odometry believes in, and what its
/// encoders add.
struct OdometryParameters {
  /// True diameter of the right wheel over that of the left (Ed in Borenstein and Feng, 1996);
  /// their mean is kept.
  double wheel_diameter_ratio = 1.0005;
  /// True track width over the nominal one (Eb there).
  double track_ratio = 1.002;
  int ticks_per_turn = 4096;
  /// Random slip: standard deviation of distance and heading after one metre; both grow with the
  /// root of the way.
  double slip_distance_sigma_per_sqrt_m = 0.005;
  double slip_yaw_sigma_rad_per_sqrt_m = 0.005;
  /// Standard deviation of the heading after turning one radian on the spot.
  double slip_yaw_sigma_rad_per_sqrt_rad = 0.005;

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

OdometryParameters readOdometryParameters(ram_parameters::ParameterReader& reader);

/// The robot that really drives: the described one with the errors of wheel diameters and track
/// built in.
RobotDescription withTrueGeometry(RobotDescription robot, const OdometryParameters& parameters);

/// What the base computes from its encoders.
struct OdometryReading {
  std::int64_t stamp_ns = 0;
  Pose2 odom_from_base;
  Twist2 twist;
  /// Of x, y, yaw [m, rad], from the random slip; a base does not know its systematic errors.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  WheelPair wheel_angles_rad;  ///< as counted
  WheelPair wheel_speeds_radps;
};

/// Counts wheel turns in ticks and integrates them with the nominal geometry.
class WheelOdometry {
public:
  /// \param robot  the nominal robot
  /// \throws std::invalid_argument from OdometryParameters::validate
  WheelOdometry(const RobotDescription& robot,
                const OdometryParameters& parameters,
                std::uint64_t seed);

  /// The wheels' true angles at a later time. The first call sets the zero.
  OdometryReading update(std::int64_t stamp_ns, const WheelPair& wheel_angles_rad);

private:
  void addSlip(const WheelPair& turned_rad);
  void integrate(const WheelPair& counted_rad);

  OdometryParameters parameters_;
  std::uint64_t seed_;
  double wheel_radius_m_;
  double track_width_m_;
  std::uint64_t updates_ = 0;
  WheelPair true_angles_rad_;
  WheelPair slipped_rad_;  // wheel angle that moved nothing, or the ground that moved no wheel
  OdometryReading reading_;
};

}  // namespace ramscout_sim
