// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/pose2.hpp"
#include "ramscout_sim/robot_description.hpp"

namespace ramscout_sim {

/// How the robot that drives differs from the robot that its odometry assumes, and what its
/// encoders add.
struct OdometryParameters {
  /// True diameter of the right wheel over that of the left (Ed in Borenstein and Feng, 1996);
  /// their mean is kept. Not for omni wheels.
  double wheel_diameter_ratio = 1.0005;
  /// True track width over the nominal one (Eb there); for omni wheels their distance from the
  /// base's centre.
  double track_ratio = 1.002;
  int ticks_per_turn = 4096;
  /// Random slip: standard deviation of distance and heading after one metre; both grow with the
  /// root of the way.
  double slip_distance_sigma_per_sqrt_m = 0.005;
  double slip_yaw_sigma_rad_per_sqrt_m = 0.005;
  /// Standard deviation of the heading after turning one radian on the spot.
  double slip_yaw_sigma_rad_per_sqrt_rad = 0.005;
  /// How well the base is calibrated as far as it knows: standard deviations of the two ratios, for
  /// the covariance only.
  double wheel_diameter_ratio_tolerance = 0.0005;
  double track_ratio_tolerance = 0.002;

  static const ram_parameters::ParameterTable<OdometryParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// The robot that really drives: the described one with the errors of wheel diameters and track
/// built in.
RobotDescription withTrueGeometry(RobotDescription robot, const OdometryParameters& parameters);

/// What the base computes from its encoders.
struct OdometryReading {
  std::int64_t stamp_ns = 0;
  Pose2 odom_from_base;
  Twist2 twist;
  /// Of x, y, yaw [m, rad] in the odom frame, from random slip and the tolerances of wheel
  /// diameters and track, to first order.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Of speed forward and to the left [m/s] and turn speed [rad/s], from random slip and ticks.
  Eigen::Matrix3d twist_covariance = Eigen::Matrix3d::Zero();
  WheelValues wheel_angles_rad = {};  ///< as counted
  WheelValues wheel_speeds_radps = {};
  WheelValues steering_rad = {};  ///< as the base reports it; WheelOdometry leaves it zero
};

/// Counts wheel turns in ticks and integrates them with the nominal geometry. Steered wheels are
/// not counted on.
class WheelOdometry {
public:
  /// \param robot  the nominal robot
  /// \throws std::invalid_argument from OdometryParameters::validate
  WheelOdometry(const RobotDescription& robot,
                const OdometryParameters& parameters,
                std::uint64_t seed);

  /// The wheels' true angles at a later time. The first call sets the zero.
  OdometryReading update(std::int64_t stamp_ns, const WheelValues& wheel_angles_rad);

  /// Starts again at pose and covariance zero; the counted wheel angles stay.
  void reset();

private:
  void addSlip(const WheelValues& turned_rad);
  void measureTwist(const WheelValues& counted_rad, double elapsed_s);
  void integrate(const Eigen::Vector3d& motion);
  void growCovariance(const Eigen::Vector3d& motion, const Eigen::Vector2d& step_m);
  Eigen::Vector3d motionOf(const WheelValues& turned_rad) const;
  Eigen::Matrix3d slipVariance(const Eigen::Vector3d& motion) const;

  OdometryParameters parameters_;
  std::uint64_t seed_;
  RobotDescription robot_;  // nominal
  Eigen::Matrix<double, Eigen::Dynamic, 3> rim_from_motion_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> motion_from_rim_;
  std::uint64_t updates_ = 0;
  WheelValues true_angles_rad_ = {};
  WheelValues slipped_rad_ = {};  // wheel angle that moved nothing, or ground that moved no wheel
  OdometryReading reading_;
  // Covariance of x, y, yaw, and of the two ratios that stay as they are for a whole run.
  Eigen::Matrix<double, 5, 5> joint_covariance_ = Eigen::Matrix<double, 5, 5>::Zero();
};

}  // namespace ramscout_sim
