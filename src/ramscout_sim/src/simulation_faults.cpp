// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "ramscout_sim/simulation.hpp"

namespace ramscout_sim {

void Simulation::inject(const Fault& fault) {
  fault.validate();
  Fault scheduled = fault;
  scheduled.start_s = std::max(fault.start_s, now_s());
  if (fault.start_s > now_s()) {
    waiting_faults_.push_back(scheduled);
  } else {
    begin(scheduled);
    begun_at_once_.push_back(scheduled);
  }
}

void Simulation::startFaults(Outputs& outputs) {
  outputs.started_faults.swap(begun_at_once_);
  if (lift_ && now_s() >= lift_->start_s + lift_->duration_s) endLift(outputs);
  if (waiting_faults_.empty()) return;
  const auto started =
      std::stable_partition(waiting_faults_.begin(), waiting_faults_.end(),
                            [this](const Fault& fault) { return fault.start_s > now_s(); });
  for (auto fault = started; fault != waiting_faults_.end(); ++fault) {
    try {
      begin(*fault);
      outputs.started_faults.push_back(*fault);
    } catch (const std::invalid_argument& error) {
      outputs.refused_faults.push_back({*fault, error.what()});
    }
  }
  waiting_faults_.erase(started, waiting_faults_.end());
}

/// \throws std::invalid_argument if the world does not allow it
void Simulation::begin(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::kPush:
      return push(fault.amount);
    case FaultKind::kOdometryReset:
      return odometry_.reset();
    case FaultKind::kKidnap:
      return setPose(fault.pose);
    case FaultKind::kDoor:
      return actors_.setDoor(fault.target, fault.amount);
    case FaultKind::kPerson:
      return addPerson(fault);
    case FaultKind::kLift:
      return beginLift(fault);
    default:
      started_faults_.push_back(fault);
  }
}

/// As far to the side as there is room.
void Simulation::push(double left_m) {
  const int tries = parameters_.push_tries;
  const Pose2 before = toPose2(physics_.worldFromBase());
  for (int i = tries; i > 0; --i) {
    try {
      physics_.setPose(before * Pose2{0.0, left_m * i / tries, 0.0});
      return;
    } catch (const std::invalid_argument&) {
      continue;  // a solid is in the way
    }
  }
}

/// The body stands while it hangs; its lidar is where the carrier has it.
void Simulation::beginLift(const Fault& fault) {
  const Pose2 before = toPose2(physics_.worldFromBase());
  setPose(fault.pose);  // whether it can be put down there
  setPose(before);
  lift_ = fault;
}

void Simulation::endLift(Outputs& outputs) {
  const Fault lift = *lift_;
  lift_.reset();
  try {
    setPose(lift.pose);
  } catch (const std::invalid_argument& error) {
    outputs.refused_faults.push_back({lift, error.what()});
  }
}

Eigen::Isometry3d Simulation::worldFromLaser() const {
  Eigen::Isometry3d world_from_base = physics_.worldFromBase();
  if (lift_) {
    const Pose2 start = toPose2(world_from_base);
    const double share = std::clamp((now_s() - lift_->start_s) / lift_->duration_s, 0.0, 1.0);
    const double turn_rad = wrapAngle(lift_->pose.yaw_rad - start.yaw_rad);
    const Pose2 carried{start.x_m + share * (lift_->pose.x_m - start.x_m),
                        start.y_m + share * (lift_->pose.y_m - start.y_m),
                        start.yaw_rad + share * turn_rad};
    world_from_base = Eigen::Translation3d(0.0, 0.0, lift_->amount) * toIsometry(carried);
  }
  Eigen::Isometry3d world_from_laser = world_from_base * robot_.base_from_laser;
  if (!started_faults_.empty()) {
    if (const Fault* tilt = activeFault(FaultKind::kLidarTilt))
      world_from_laser.rotate(Eigen::AngleAxisd(tilt->amount, Eigen::Vector3d::UnitY()));
  }
  return world_from_laser;
}

void Simulation::addPerson(const Fault& fault) {
  Person person;
  const Eigen::Vector2d ahead(std::cos(fault.pose.yaw_rad), std::sin(fault.pose.yaw_rad));
  const Eigen::Vector2d start(fault.pose.x_m, fault.pose.y_m);
  const double way_m = std::max(1e-3, fault.amount * fault.duration_s);
  person.waypoints_m = {start, start + way_m * ahead};
  person.speed_mps = fault.amount;
  actors_.addPerson(person, now_s() + fault.duration_s);
}

/// What lies on the chassis: a cube.
MassProperties Simulation::payload() const {
  MassProperties cube;
  const Fault* fault = activeFault(FaultKind::kPayload);
  if (!fault) return cube;
  World parts;
  parts.solids = robot_.chassis_shapes;
  const double edge_m = std::cbrt(fault->amount / parameters_.payload_density_kgpm3);
  cube.mass_kg = fault->amount;
  cube.center_in_base_m = {fault->pose.x_m, fault->pose.y_m,
                           boundsOf(parts).max().z() + 0.5 * edge_m};
  cube.inertia_kgm2 = Eigen::Matrix3d::Identity() * (fault->amount * edge_m * edge_m / 6.0);
  return cube;
}

/// Blocked wheels, a slippery floor, a shove, a payload.
void Simulation::applyForces() {
  if (activeFault(FaultKind::kLeftWheelBlocked)) wheel_motion_.speeds_radps[0] = 0.0;
  if (activeFault(FaultKind::kRightWheelBlocked)) wheel_motion_.speeds_radps[1] = 0.0;
  const Fault* floor = activeFault(FaultKind::kFloorFriction);
  const Fault* shove = activeFault(FaultKind::kShove);
  physics_.setFloorFriction(floor ? floor->amount : floor_friction_);
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  if (shove) {
    force_n = shove->amount * (physics_.worldFromBase().linear() * Eigen::Vector3d::UnitY());
    force_n.z() = 0.0;
  }
  physics_.setPush(force_n);
  const MassProperties carried = payload();
  if (carried.mass_kg != payload_.mass_kg ||
      carried.center_in_base_m != payload_.center_in_base_m) {
    physics_.setPayload(carried);
    payload_ = carried;
  }
  forced_ = floor || shove || carried.mass_kg > 0.0;
}

/// The fault of this kind that holds now and started last; null if there is none.
const Fault* Simulation::activeFault(FaultKind kind) const {
  for (auto fault = started_faults_.rbegin(); fault != started_faults_.rend(); ++fault) {
    if (fault->kind == kind && now_s() < fault->start_s + fault->duration_s) return &*fault;
  }
  return nullptr;
}

void Simulation::maskSector(Scan& scan) const {
  const Fault* sector = activeFault(FaultKind::kScanSector);
  if (!sector) return;
  const LidarParameters& lidar = parameters_.lidar;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const double bearing_rad =
        lidar.angle_min_rad + static_cast<double>(beam) * lidar.angleIncrement_rad();
    if (bearing_rad >= sector->angle_min_rad && bearing_rad <= sector->angle_max_rad) {
      scan.ranges_m[beam] = -std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace ramscout_sim
