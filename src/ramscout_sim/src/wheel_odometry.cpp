// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/wheel_odometry.hpp"

#include <cmath>

#include "ramscout_sim/drive.hpp"
#include "ramscout_sim/random.hpp"

namespace ramscout_sim {
namespace {

double square(double x) {
  return x * x;
}

}  // namespace

const ram_parameters::ParameterTable<OdometryParameters>& OdometryParameters::table() {
  using namespace ram_parameters;
  using P = OdometryParameters;
  static const auto table =
      ParameterTable<P>()
          .add("wheel_diameter_ratio", &P::wheel_diameter_ratio, "", between(0.5, 2.0),
               "True diameter of the right wheel over the left (Ed of Borenstein and Feng); 1: "
               "equal. Not for omni wheels.")
          .add("track_ratio", &P::track_ratio, "", between(0.5, 2.0),
               "True over nominal track width (Eb); 1: as nominal.")
          .add("ticks_per_turn", &P::ticks_per_turn, "", within(4, 1e7), "Of the wheel encoders.")
          .add("slip_distance_sigma_per_sqrt_m", &P::slip_distance_sigma_per_sqrt_m, "m/sqrt(m)",
               atLeast(0.0), "Standard deviation of the driven distance after 1 m.")
          .add("slip_yaw_sigma_rad_per_sqrt_m", &P::slip_yaw_sigma_rad_per_sqrt_m, "rad/sqrt(m)",
               atLeast(0.0), "Standard deviation of the heading after 1 m.")
          .add("slip_yaw_sigma_rad_per_sqrt_rad", &P::slip_yaw_sigma_rad_per_sqrt_rad,
               "rad/sqrt(rad)", atLeast(0.0),
               "Standard deviation of the heading after turning 1 rad.")
          .add("wheel_diameter_ratio_tolerance", &P::wheel_diameter_ratio_tolerance, "",
               within(0.0, 1.0),
               "Standard deviation that the base ascribes to wheel_diameter_ratio: for the "
               "published covariance only.")
          .add("track_ratio_tolerance", &P::track_ratio_tolerance, "", within(0.0, 1.0),
               "The same for track_ratio.");
  return table;
}

RobotDescription withTrueGeometry(RobotDescription robot, const OdometryParameters& parameters) {
  if (robot.kind == BaseKind::kOmnidirectional) {
    for (Wheel& wheel : robot.wheels) {
      wheel.center_in_base_m.head<2>() *= parameters.track_ratio;
      wheel.mass.center_in_base_m.head<2>() *= parameters.track_ratio;
    }
    return robot;
  }
  const double ratio = parameters.wheel_diameter_ratio;
  const auto change = [&parameters](Wheel& wheel, double factor) {
    wheel.radius_m *= factor;
    wheel.center_in_base_m.z() = wheel.mass.center_in_base_m.z() = wheel.radius_m;
    wheel.center_in_base_m.y() *= parameters.track_ratio;
    wheel.mass.center_in_base_m.y() *= parameters.track_ratio;
  };
  change(robot.wheels.at(0), 2.0 / (1.0 + ratio));
  change(robot.wheels.at(1), 2.0 * ratio / (1.0 + ratio));
  return robot;
}

WheelOdometry::WheelOdometry(const RobotDescription& robot,
                             const OdometryParameters& parameters,
                             std::uint64_t seed)
    : parameters_((parameters.validate(), parameters)),
      seed_(seed),
      robot_(robot),
      rim_from_motion_(rimSpeedFromMotion(robot)),
      motion_from_rim_(motionFromRimSpeed(robot)) {
  joint_covariance_(3, 3) = square(parameters_.wheel_diameter_ratio_tolerance);
  joint_covariance_(4, 4) = square(parameters_.track_ratio_tolerance);
}

OdometryReading WheelOdometry::update(std::int64_t stamp_ns, const WheelValues& wheel_angles_rad) {
  WheelValues turned = {};
  for (std::size_t i = 0; i < turned.size(); ++i) {
    turned[i] = wheel_angles_rad[i] - true_angles_rad_[i];
    if (updates_ == 0) slipped_rad_[i] = -wheel_angles_rad[i];
  }
  if (updates_ > 0) addSlip(turned);
  true_angles_rad_ = wheel_angles_rad;
  const double tick_rad = 2.0 * M_PI / parameters_.ticks_per_turn;
  WheelValues angles = {};
  WheelValues counted = {};
  for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
    angles[i] = std::floor((wheel_angles_rad[i] + slipped_rad_[i]) / tick_rad + 0.5) * tick_rad;
    counted[i] = angles[i] - reading_.wheel_angles_rad[i];
  }
  const double elapsed_s = static_cast<double>(stamp_ns - reading_.stamp_ns) * 1e-9;
  if (updates_ > 0 && elapsed_s > 0.0) {
    measureTwist(counted, elapsed_s);
    integrate(motionOf(counted));
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

void WheelOdometry::measureTwist(const WheelValues& counted_rad, double elapsed_s) {
  const Eigen::Vector3d motion = motionOf(counted_rad);
  reading_.twist = {motion.x() / elapsed_s, motion.y() / elapsed_s, motion.z() / elapsed_s};
  reading_.twist_covariance = slipVariance(motion);
  // Each wheel's count is off by a uniform error of half a tick at both ends.
  const double tick_rad = 2.0 * M_PI / parameters_.ticks_per_turn;
  for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
    reading_.wheel_speeds_radps[i] = counted_rad[i] / elapsed_s;
    const Eigen::Vector3d column = motion_from_rim_.col(static_cast<Eigen::Index>(i));
    const double variance_m2 = square(robot_.wheels[i].radius_m * tick_rad) / 6.0;
    reading_.twist_covariance += variance_m2 * column * column.transpose();
  }
  reading_.twist_covariance /= square(elapsed_s);
}

/// Way forward and to the left, and turn.
Eigen::Vector3d WheelOdometry::motionOf(const WheelValues& turned_rad) const {
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
    motion += motion_from_rim_.col(static_cast<Eigen::Index>(i)) * robot_.wheels[i].radius_m *
              turned_rad[i];
  }
  return motion;
}

void WheelOdometry::addSlip(const WheelValues& turned_rad) {
  const Eigen::Matrix3d variance = slipVariance(motionOf(turned_rad));
  Random random(seed_, Stream::kSlip, updates_);
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();
  for (const int i : {0, 2, 1}) slip[i] = std::sqrt(variance(i, i)) * random.gaussian();
  for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
    slipped_rad_[i] +=
        rim_from_motion_.row(static_cast<Eigen::Index>(i)).dot(slip) / robot_.wheels[i].radius_m;
  }
}

/// Of the way forward and to the left, and of the heading, after such a motion.
Eigen::Matrix3d WheelOdometry::slipVariance(const Eigen::Vector3d& motion) const {
  const double distance_m = motion.head<2>().norm();
  const double yaw_rad = std::abs(motion.z());
  Eigen::Matrix3d variance = Eigen::Matrix3d::Zero();
  variance(0, 0) = square(parameters_.slip_distance_sigma_per_sqrt_m) * distance_m;
  if (robot_.kind == BaseKind::kOmnidirectional) variance(1, 1) = variance(0, 0);
  variance(2, 2) = square(parameters_.slip_yaw_sigma_rad_per_sqrt_m) * distance_m +
                   square(parameters_.slip_yaw_sigma_rad_per_sqrt_rad) * yaw_rad;
  return variance;
}

// Exact for a circular arc.
void WheelOdometry::integrate(const Eigen::Vector3d& motion) {
  const double half = 0.5 * motion.z();
  const double chord = std::abs(half) < 1e-6 ? 1.0 : std::sin(half) / half;
  Pose2& pose = reading_.odom_from_base;
  const Eigen::Vector2d step_m =
      chord * (Eigen::Rotation2Dd(pose.yaw_rad + half) * motion.head<2>());
  growCovariance(motion, step_m);
  pose = {pose.x_m + step_m.x(), pose.y_m + step_m.y(), wrapAngle(pose.yaw_rad + motion.z())};
}

// To first order (Thrun et al., Probabilistic Robotics, 2005, 5.4), with wheel diameters and track
// as unknown constants: their errors add up instead of averaging out.
void WheelOdometry::growCovariance(const Eigen::Vector3d& motion, const Eigen::Vector2d& step_m) {
  const double c = std::cos(reading_.odom_from_base.yaw_rad + 0.5 * motion.z());
  const double s = std::sin(reading_.odom_from_base.yaw_rad + 0.5 * motion.z());
  Eigen::Matrix3d from_motion;              // d pose / d motion
  from_motion << c, -s, -0.5 * step_m.y(),  //
      s, c, 0.5 * step_m.x(),               //
      0.0, 0.0, 1.0;
  Eigen::Matrix<double, 3, 2> from_ratios;  // d motion / d (Ed, Eb)
  from_ratios.setZero();
  if (robot_.kind != BaseKind::kOmnidirectional) {
    from_ratios(0, 0) = 0.25 * motion.z() * robot_.trackWidth_m();
    from_ratios(2, 0) = motion.x() / robot_.trackWidth_m();
  }
  from_ratios(2, 1) = -motion.z();
  Eigen::Matrix<double, 5, 5> step = Eigen::Matrix<double, 5, 5>::Identity();
  step(0, 2) = -step_m.y();
  step(1, 2) = step_m.x();
  step.block<3, 2>(0, 3) = from_motion * from_ratios;
  joint_covariance_ = (step * joint_covariance_ * step.transpose()).eval();
  joint_covariance_.topLeftCorner<3, 3>() +=
      from_motion * slipVariance(motion) * from_motion.transpose();
  reading_.covariance = joint_covariance_.topLeftCorner<3, 3>();
}

}  // namespace ramscout_sim
