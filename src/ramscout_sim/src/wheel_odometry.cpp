// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/wheel_odometry.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "ramscout_sim/random.hpp"

namespace ramscout_sim {
namespace {

void require(bool condition, const char* parameter, double value, const char* bound) {
  if (!condition) {
    throw std::invalid_argument(std::string("odometry.") + parameter + " must be " + bound +
                                ", got " + std::to_string(value));
  }
}

double square(double x) {
  return x * x;
}

}  // namespace

void OdometryParameters::validate() const {
  require(wheel_diameter_ratio > 0.5 && wheel_diameter_ratio < 2.0, "wheel_diameter_ratio",
          wheel_diameter_ratio, "in (0.5, 2)");
  require(track_ratio > 0.5 && track_ratio < 2.0, "track_ratio", track_ratio, "in (0.5, 2)");
  require(ticks_per_turn >= 4 && ticks_per_turn <= 10000000, "ticks_per_turn", ticks_per_turn,
          "4 to 1e7");
  require(slip_distance_sigma_per_sqrt_m >= 0.0, "slip_distance_sigma_per_sqrt_m",
          slip_distance_sigma_per_sqrt_m, ">= 0");
  require(slip_yaw_sigma_rad_per_sqrt_m >= 0.0, "slip_yaw_sigma_rad_per_sqrt_m",
          slip_yaw_sigma_rad_per_sqrt_m, ">= 0");
  require(slip_yaw_sigma_rad_per_sqrt_rad >= 0.0, "slip_yaw_sigma_rad_per_sqrt_rad",
          slip_yaw_sigma_rad_per_sqrt_rad, ">= 0");
  require(wheel_diameter_ratio_tolerance >= 0.0 && wheel_diameter_ratio_tolerance <= 1.0,
          "wheel_diameter_ratio_tolerance", wheel_diameter_ratio_tolerance, "in [0, 1]");
  require(track_ratio_tolerance >= 0.0 && track_ratio_tolerance <= 1.0, "track_ratio_tolerance",
          track_ratio_tolerance, "in [0, 1]");
}

OdometryParameters readOdometryParameters(ram_parameters::ParameterReader& reader) {
  OdometryParameters p;
  reader.read("wheel_diameter_ratio", p.wheel_diameter_ratio);
  reader.read("track_ratio", p.track_ratio);
  reader.read("ticks_per_turn", p.ticks_per_turn);
  reader.read("slip_distance_sigma_per_sqrt_m", p.slip_distance_sigma_per_sqrt_m);
  reader.read("slip_yaw_sigma_rad_per_sqrt_m", p.slip_yaw_sigma_rad_per_sqrt_m);
  reader.read("slip_yaw_sigma_rad_per_sqrt_rad", p.slip_yaw_sigma_rad_per_sqrt_rad);
  reader.read("wheel_diameter_ratio_tolerance", p.wheel_diameter_ratio_tolerance);
  reader.read("track_ratio_tolerance", p.track_ratio_tolerance);
  reader.rejectUnknown();
  p.validate();
  return p;
}

RobotDescription withTrueGeometry(RobotDescription robot, const OdometryParameters& parameters) {
  const double ratio = parameters.wheel_diameter_ratio;
  const auto scaleRadius = [](Wheel& wheel, double factor) {
    wheel.radius_m *= factor;
    wheel.center_in_base_m.z() = wheel.radius_m;
    wheel.mass.center_in_base_m.z() = wheel.radius_m;
  };
  scaleRadius(robot.right, 2.0 * ratio / (1.0 + ratio));
  scaleRadius(robot.left, 2.0 / (1.0 + ratio));
  for (Wheel* wheel : {&robot.left, &robot.right}) {
    wheel->center_in_base_m.y() *= parameters.track_ratio;
    wheel->mass.center_in_base_m.y() *= parameters.track_ratio;
  }
  return robot;
}

WheelOdometry::WheelOdometry(const RobotDescription& robot,
                             const OdometryParameters& parameters,
                             std::uint64_t seed)
    : parameters_((parameters.validate(), parameters)),
      seed_(seed),
      wheel_radius_m_(0.5 * (robot.left.radius_m + robot.right.radius_m)),
      track_width_m_(robot.trackWidth_m()) {
  joint_covariance_(3, 3) = square(parameters_.wheel_diameter_ratio_tolerance);
  joint_covariance_(4, 4) = square(parameters_.track_ratio_tolerance);
}

OdometryReading WheelOdometry::update(std::int64_t stamp_ns, const WheelPair& wheel_angles_rad) {
  if (updates_ > 0) {
    addSlip({wheel_angles_rad.left - true_angles_rad_.left,
             wheel_angles_rad.right - true_angles_rad_.right});
  } else {
    slipped_rad_ = {-wheel_angles_rad.left, -wheel_angles_rad.right};
  }
  true_angles_rad_ = wheel_angles_rad;
  const double tick_rad = 2.0 * M_PI / parameters_.ticks_per_turn;
  const WheelPair angles = {
      std::floor((wheel_angles_rad.left + slipped_rad_.left) / tick_rad + 0.5) * tick_rad,
      std::floor((wheel_angles_rad.right + slipped_rad_.right) / tick_rad + 0.5) * tick_rad};
  const WheelPair counted = {angles.left - reading_.wheel_angles_rad.left,
                             angles.right - reading_.wheel_angles_rad.right};
  const double elapsed_s = static_cast<double>(stamp_ns - reading_.stamp_ns) * 1e-9;
  if (updates_ > 0 && elapsed_s > 0.0) {
    reading_.wheel_speeds_radps = {counted.left / elapsed_s, counted.right / elapsed_s};
    reading_.twist = {
        0.5 * wheel_radius_m_ * (counted.left + counted.right) / elapsed_s, 0.0,
        wheel_radius_m_ * (counted.right - counted.left) / track_width_m_ / elapsed_s};
    // Each wheel's count is off by a uniform error of half a tick at both ends.
    const double tick_variance_m2 = square(wheel_radius_m_ * tick_rad) / 6.0;
    reading_.twist_covariance =
        slipVariance(reading_.twist.forward_mps * elapsed_s, reading_.twist.turn_radps * elapsed_s);
    reading_.twist_covariance(0, 0) += 0.5 * tick_variance_m2;
    reading_.twist_covariance(1, 1) += 2.0 * tick_variance_m2 / square(track_width_m_);
    reading_.twist_covariance /= square(elapsed_s);
    integrate(counted);
  }
  reading_.wheel_angles_rad = angles;
  reading_.stamp_ns = stamp_ns;
  ++updates_;
  return reading_;
}

void WheelOdometry::reset() {
  reading_.odom_from_base = {};
  reading_.covariance.setZero();
  joint_covariance_.topRows<3>().setZero();
  joint_covariance_.leftCols<3>().setZero();
}

void WheelOdometry::addSlip(const WheelPair& turned_rad) {
  const double distance_m = 0.5 * wheel_radius_m_ * (turned_rad.left + turned_rad.right);
  const double yaw_rad = wheel_radius_m_ * (turned_rad.right - turned_rad.left) / track_width_m_;
  const Eigen::Matrix2d variance = slipVariance(distance_m, yaw_rad);
  Random random(seed_, Stream::kSlip, updates_);
  const double slip_m = std::sqrt(variance(0, 0)) * random.gaussian();
  const double slip_rad = std::sqrt(variance(1, 1)) * random.gaussian();
  slipped_rad_.left += (slip_m - 0.5 * track_width_m_ * slip_rad) / wheel_radius_m_;
  slipped_rad_.right += (slip_m + 0.5 * track_width_m_ * slip_rad) / wheel_radius_m_;
}

/// Of distance and heading after such a motion.
Eigen::Matrix2d WheelOdometry::slipVariance(double distance_m, double yaw_rad) const {
  Eigen::Matrix2d variance = Eigen::Matrix2d::Zero();
  variance(0, 0) = square(parameters_.slip_distance_sigma_per_sqrt_m) * std::abs(distance_m);
  variance(1, 1) = square(parameters_.slip_yaw_sigma_rad_per_sqrt_m) * std::abs(distance_m) +
                   square(parameters_.slip_yaw_sigma_rad_per_sqrt_rad) * std::abs(yaw_rad);
  return variance;
}

// Exact for a circular arc.
void WheelOdometry::integrate(const WheelPair& counted_rad) {
  const double distance_m = 0.5 * wheel_radius_m_ * (counted_rad.left + counted_rad.right);
  const double yaw_rad = wheel_radius_m_ * (counted_rad.right - counted_rad.left) / track_width_m_;
  const double half = 0.5 * yaw_rad;
  const double chord_m = std::abs(half) < 1e-6 ? distance_m : distance_m * std::sin(half) / half;
  growCovariance(chord_m, yaw_rad, distance_m);
  Pose2& pose = reading_.odom_from_base;
  pose = {pose.x_m + chord_m * std::cos(pose.yaw_rad + half),
          pose.y_m + chord_m * std::sin(pose.yaw_rad + half), wrapAngle(pose.yaw_rad + yaw_rad)};
}

// To first order (Thrun et al., Probabilistic Robotics, 2005, 5.4), with wheel diameters and track
// as unknown constants: their errors add up instead of averaging out.
void WheelOdometry::growCovariance(double chord_m, double yaw_rad, double distance_m) {
  const double c = std::cos(reading_.odom_from_base.yaw_rad + 0.5 * yaw_rad);
  const double s = std::sin(reading_.odom_from_base.yaw_rad + 0.5 * yaw_rad);
  Eigen::Matrix<double, 3, 2> from_motion;  // d pose / d (distance, yaw)
  from_motion << c, -0.5 * chord_m * s,     //
      s, 0.5 * chord_m * c,                 //
      0.0, 1.0;
  Eigen::Matrix2d from_ratios = Eigen::Matrix2d::Zero();  // d (distance, yaw) / d (Ed, Eb)
  from_ratios(0, 0) = 0.25 * yaw_rad * track_width_m_;
  from_ratios(1, 0) = distance_m / track_width_m_;
  from_ratios(1, 1) = -yaw_rad;
  Eigen::Matrix<double, 5, 5> step = Eigen::Matrix<double, 5, 5>::Identity();
  step(0, 2) = -chord_m * s;
  step(1, 2) = chord_m * c;
  step.block<3, 2>(0, 3) = from_motion * from_ratios;
  joint_covariance_ = (step * joint_covariance_ * step.transpose()).eval();
  joint_covariance_.topLeftCorner<3, 3>() +=
      from_motion * slipVariance(distance_m, yaw_rad) * from_motion.transpose();
  reading_.covariance = joint_covariance_.topLeftCorner<3, 3>();
}

}  // namespace ramscout_sim
