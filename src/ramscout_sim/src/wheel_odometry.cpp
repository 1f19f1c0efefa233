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
}

OdometryParameters readOdometryParameters(ram_parameters::ParameterReader& reader) {
  OdometryParameters p;
  reader.read("wheel_diameter_ratio", p.wheel_diameter_ratio);
  reader.read("track_ratio", p.track_ratio);
  reader.read("ticks_per_turn", p.ticks_per_turn);
  reader.read("slip_distance_sigma_per_sqrt_m", p.slip_distance_sigma_per_sqrt_m);
  reader.read("slip_yaw_sigma_rad_per_sqrt_m", p.slip_yaw_sigma_rad_per_sqrt_m);
  reader.read("slip_yaw_sigma_rad_per_sqrt_rad", p.slip_yaw_sigma_rad_per_sqrt_rad);
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
      track_width_m_(robot.trackWidth_m()) {}

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
    integrate(counted);
  }
  reading_.wheel_angles_rad = angles;
  reading_.stamp_ns = stamp_ns;
  ++updates_;
  return reading_;
}

void WheelOdometry::addSlip(const WheelPair& turned_rad) {
  const double distance_m = 0.5 * wheel_radius_m_ * std::abs(turned_rad.left + turned_rad.right);
  const double yaw_rad =
      wheel_radius_m_ * std::abs(turned_rad.right - turned_rad.left) / track_width_m_;
  Random random(seed_, Stream::kSlip, updates_);
  const double slip_m =
      parameters_.slip_distance_sigma_per_sqrt_m * std::sqrt(distance_m) * random.gaussian();
  const double slip_rad = std::sqrt(square(parameters_.slip_yaw_sigma_rad_per_sqrt_m) * distance_m +
                                    square(parameters_.slip_yaw_sigma_rad_per_sqrt_rad) * yaw_rad) *
                          random.gaussian();
  slipped_rad_.left += (slip_m - 0.5 * track_width_m_ * slip_rad) / wheel_radius_m_;
  slipped_rad_.right += (slip_m + 0.5 * track_width_m_ * slip_rad) / wheel_radius_m_;
}

// Exact for a circular arc. The covariance follows to first order (Thrun et al., Probabilistic
// Robotics, 2005, 5.4).
void WheelOdometry::integrate(const WheelPair& counted_rad) {
  const double distance_m = 0.5 * wheel_radius_m_ * (counted_rad.left + counted_rad.right);
  const double yaw_rad = wheel_radius_m_ * (counted_rad.right - counted_rad.left) / track_width_m_;
  const double half = 0.5 * yaw_rad;
  const double chord_m = std::abs(half) < 1e-6 ? distance_m : distance_m * std::sin(half) / half;
  Pose2& pose = reading_.odom_from_base;
  const double c = std::cos(pose.yaw_rad + half);
  const double s = std::sin(pose.yaw_rad + half);
  pose = {pose.x_m + chord_m * c, pose.y_m + chord_m * s, wrapAngle(pose.yaw_rad + yaw_rad)};

  Eigen::Matrix3d from_pose = Eigen::Matrix3d::Identity();
  from_pose(0, 2) = -chord_m * s;
  from_pose(1, 2) = chord_m * c;
  Eigen::Matrix<double, 3, 2> from_motion;
  from_motion << c, -0.5 * chord_m * s,  //
      s, 0.5 * chord_m * c,              //
      0.0, 1.0;
  Eigen::Matrix2d motion = Eigen::Matrix2d::Zero();
  motion(0, 0) = square(parameters_.slip_distance_sigma_per_sqrt_m) * std::abs(distance_m);
  motion(1, 1) = square(parameters_.slip_yaw_sigma_rad_per_sqrt_m) * std::abs(distance_m) +
                 square(parameters_.slip_yaw_sigma_rad_per_sqrt_rad) * std::abs(yaw_rad);
  reading_.covariance = from_pose * reading_.covariance * from_pose.transpose() +
                        from_motion * motion * from_motion.transpose();
}

}  // namespace ramscout_sim
