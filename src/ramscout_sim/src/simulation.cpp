// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ramscout_sim/start_pose.hpp"

namespace ramscout_sim {
namespace {

/// When the n-th of a series with the given rate is due.
std::int64_t dueAt_ns(std::uint64_t index, double rate_hz) {
  return Simulation::kStart_ns + std::llround(static_cast<double>(index) / rate_hz * 1e9);
}

}  // namespace

Simulation::Simulation(const SimulationParameters& parameters,
                       const RobotDescription& robot,
                       const World& world,
                       const std::optional<Tour>& tour)
    : parameters_((parameters.validate(), parameters)),
      robot_(robot),
      ray_caster_(world, parameters.instruction_set),
      physics_(
          startedPhysics(withTrueGeometry(robot, parameters.odometry), world, parameters.physics)),
      actors_(world, parameters.actors),
      odometry_(robot, parameters.odometry, static_cast<std::uint64_t>(parameters.seed)),
      drive_(robot, parameters.drive),
      lidar_(parameters.lidar, static_cast<std::uint64_t>(parameters.seed)) {
  floor_friction_ = world.floor_friction;
  World parts;
  parts.solids = robot.chassis_shapes;
  const Eigen::AlignedBox3d bounds = boundsOf(parts);
  radius_m_ = bounds.min().head<2>().cwiseAbs().cwiseMax(bounds.max().head<2>().cwiseAbs()).norm();
  if (tour) driver_.emplace(*tour, parameters.tour_driver);
  rememberPose();
}

void Simulation::command(const Twist2& twist) {
  commanded_at_ns_ = now_ns_;
  commanded_ = {};
  if (!std::isfinite(twist.forward_mps) || !std::isfinite(twist.left_mps) ||
      !std::isfinite(twist.turn_radps)) {
    throw std::invalid_argument("a velocity command that is not finite: the robot stops");
  }
  commanded_ = twist;
}

Twist2 Simulation::wantedTwist() {
  Twist2 wanted;
  if (activeFault(FaultKind::kMotorsDead) || lift_) return wanted;
  if (driver_) {
    if (now_ns_ >= next_drive_ns_) {
      driven_ = driver_->drive(toPose2(physics_.worldFromBase()));
      next_drive_ns_ = now_ns_ + std::llround(parameters_.actors.period_s * 1e9);
    }
    wanted = driven_;
  } else if (now_ns_ - commanded_at_ns_ <=
             std::llround(parameters_.drive.command_timeout_s * 1e9)) {
    wanted = commanded_;
  }
  return wanted;
}

Outputs Simulation::step() {
  Outputs outputs;
  if (steps_ == 0 && odometry_count_ == 0) {
    outputs.odometry = readOdometry();
    outputs.ground_truth = groundTruth();
    ++odometry_count_;
    return outputs;
  }
  ++steps_;
  const std::int64_t next_ns =
      kStart_ns + std::llround(static_cast<double>(steps_) / parameters_.physics_rate_hz * 1e9);
  const double duration_s = 1.0 / parameters_.physics_rate_hz;
  startFaults(outputs);
  if (!actors_.empty()) moveActors();
  wheel_motion_ = drive_.advance(wantedTwist(), duration_s);
  if (!started_faults_.empty() || forced_) applyForces();
  physics_.step(duration_s, wheel_motion_);
  now_ns_ = next_ns;
  rememberPose();
  if (now_ns_ >= dueAt_ns(odometry_count_, parameters_.odometry_rate_hz)) {
    outputs.odometry = readOdometry();
    outputs.ground_truth = groundTruth();
    ++odometry_count_;
  }
  outputs.scan = scanIfDue();
  return outputs;
}

void Simulation::rememberPose() {
  recent_path_.stamps_ns.push_back(now_ns_);
  recent_path_.world_from_laser.push_back(worldFromLaser());
}

std::optional<Scan> Simulation::scanIfDue() {
  const std::int64_t stamp_ns = dueAt_ns(scan_count_, parameters_.lidar.scan_rate_hz);
  if (now_ns_ < stamp_ns + std::llround(parameters_.lidar.sweep_s() * 1e9)) return std::nullopt;
  std::vector<Solid> moving;
  if (!actors_.empty()) {
    moving = actors_.solidsInSweep(static_cast<double>(stamp_ns - kStart_ns) * 1e-9,
                                   recent_path_.world_from_laser.back(), parameters_.lidar);
  }
  Scan scan = lidar_.measure(stamp_ns, scan_count_, recent_path_, ray_caster_, moving);
  ++scan_count_;
  // Keep one sample at or before the next scan's start.
  const std::int64_t next_ns = dueAt_ns(scan_count_, parameters_.lidar.scan_rate_hz);
  const auto after =
      std::upper_bound(recent_path_.stamps_ns.begin(), recent_path_.stamps_ns.end(), next_ns);
  const std::ptrdiff_t obsolete =
      std::max<std::ptrdiff_t>(0, after - recent_path_.stamps_ns.begin() - 1);
  recent_path_.stamps_ns.erase(recent_path_.stamps_ns.begin(),
                               recent_path_.stamps_ns.begin() + obsolete);
  recent_path_.world_from_laser.erase(recent_path_.world_from_laser.begin(),
                                      recent_path_.world_from_laser.begin() + obsolete);
  if (activeFault(FaultKind::kScanDropout)) return std::nullopt;
  maskSector(scan);
  if (const Fault* offset = activeFault(FaultKind::kClockOffset)) {
    const std::int64_t earliest_ns = 1;  // 0 is no time
    scan.stamp_ns =
        std::max<std::int64_t>(earliest_ns, scan.stamp_ns + std::llround(offset->amount * 1e9));
  }
  return scan;
}

OdometryReading Simulation::readOdometry() {
  OdometryReading reading = odometry_.update(now_ns_, encoderAngles_rad());
  reading.steering_rad = wheel_motion_.steering_rad;
  return reading;
}

WheelValues Simulation::encoderAngles_rad() {
  WheelValues angles = physics_.wheelAngles_rad();
  const Fault* slip = activeFault(FaultKind::kWheelSlip);
  for (std::size_t i = 0; i < robot_.wheels.size(); ++i) {
    const double turned_rad = angles[i] - true_angles_rad_[i];
    if (slip) encoder_error_rad_[i] += slip->amount * turned_rad;
    const Fault* own_slip =
        i < 2 ? activeFault(i == 0 ? FaultKind::kLeftWheelSlip : FaultKind::kRightWheelSlip)
              : nullptr;
    if (own_slip) encoder_error_rad_[i] += own_slip->amount * turned_rad;
    if (activeFault(i == 0 ? FaultKind::kLeftEncoderDead : FaultKind::kRightEncoderDead) && i < 2)
      encoder_error_rad_[i] -= turned_rad;
    true_angles_rad_[i] = angles[i];
    angles[i] += encoder_error_rad_[i];
  }
  return angles;
}

void Simulation::setPose(const Pose2& world_from_base) {
  if (!actors_.empty()) physics_.setObstacles(actors_.solids());  // those there, not those here
  physics_.setPose(world_from_base);
  drive_.stop();
  commanded_ = {};
}

GroundTruth Simulation::groundTruth() const {
  GroundTruth truth;
  truth.stamp_ns = now_ns_;
  truth.world_from_base = physics_.worldFromBase();
  const Eigen::Matrix3d base_from_world = truth.world_from_base.linear().transpose();
  truth.linear_velocity_mps = base_from_world * physics_.linearVelocity_mps();
  truth.angular_velocity_radps = base_from_world * physics_.angularVelocity_radps();
  return truth;
}

std::vector<Solid> Simulation::chassis() const {
  std::vector<Solid> shapes = robot_.chassis_shapes;
  for (Solid& shape : shapes)
    shape.world_from_solid = physics_.worldFromBase() * shape.world_from_solid;
  return shapes;
}

Footprint Simulation::footprint() const {
  const Pose2 pose = toPose2(physics_.worldFromBase());
  return {{pose.x_m, pose.y_m}, radius_m_};
}

void Simulation::setOthers(std::vector<Solid> shapes, std::vector<Footprint> footprints) {
  actors_.setGuests(std::move(shapes));
  others_ = std::move(footprints);
}

/// People, doors and other robots move on, and what of them is near enough can be touched.
void Simulation::moveActors() {
  const Footprint own = footprint();
  std::vector<Footprint> robots = others_;
  robots.push_back(own);
  if (!actors_.advance(now_s(), robots)) return;
  std::vector<Solid> near;
  for (const Solid& solid : actors_.solids()) {
    const double distance_m =
        (solid.world_from_solid.translation().head<2>() - own.center_m).norm();
    const double reach_m = own.radius_m + 0.5 * solid.size_m.norm();
    if (distance_m < reach_m + parameters_.actors.touch_range_m) near.push_back(solid);
  }
  physics_.setObstacles(near);
}

}  // namespace ramscout_sim
