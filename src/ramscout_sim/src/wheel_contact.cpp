// SPDX-License-Identifier: BSD-3-Clause
#include "wheel_contact.hpp"

#include <algorithm>
#include <cmath>

namespace ramscout_sim {
WheelContact::WheelContact(const Wheel& wheel,
                           std::size_t number,
                           const PhysicsParameters& parameters)
    : description(wheel),
      inertia_kgm2(wheel.axle_in_base.dot(wheel.mass.inertia_kgm2 * wheel.axle_in_base)),
      friction_share(1.0 + parameters.wheel_tie_breaker * static_cast<double>(number)),
      softness(parameters.wheel_softness),
      friction_softness(parameters.friction_softness) {
  if (wheel.max_torque_nm == 0.0) fixed_torque_nm = 0.0;
}

Eigen::Vector3d WheelContact::axleInBody() const {
  return Eigen::AngleAxisd(steering_rad, Eigen::Vector3d::UnitZ()) * description.axle_in_base;
}

void WheelContact::touch(const Ground& ground,
                         const Eigen::Vector3d& center_m,
                         const Eigen::Vector3d& axle_in_world,
                         double friction) {
  contact = {};
  touches_ground = ground.touch(center_m, description.radius_m, contact.geom);
  if (!touches_ground) return;
  rolling = axle_in_world.cross(toEigen(contact.geom.normal)).normalized();
  for (int i = 0; i < 3; ++i) contact.fdir1[i] = rolling[i];
  dSurfaceParameters& surface = contact.surface;
  surface.mode = dContactMu2 | dContactFDir1 | dContactMotion1 | dContactSlip1 | dContactSoftCFM;
  surface.mu = friction * load_n * friction_share;
  surface.mu2 = description.omni ? 0.0 : surface.mu;
  surface.soft_cfm = softness;
}

void WheelContact::drive(double duration_s, double target_radps) {
  dSurfaceParameters& surface = contact.surface;
  const double radius_m = description.radius_m;
  surface.motion1 = radius_m * target_radps;
  surface.slip1 = friction_softness;
  if (fixed_torque_nm) {
    const double per_torque = duration_s / inertia_kgm2;
    surface.motion1 = radius_m * (speed_radps + per_torque * *fixed_torque_nm);
    surface.slip1 += radius_m * radius_m * per_torque;
  }
}

/// The torque that would bring the wheel to the target speed.
double WheelContact::neededTorque_nm(double duration_s, double target_radps) const {
  return inertia_kgm2 * (target_radps - speed_radps) / duration_s +
         description.radius_m * traction_n();
}

bool WheelContact::didAsAssumed(double duration_s, double target_radps) {
  const double limit_nm = description.max_torque_nm;
  if (limit_nm == 0.0) return true;
  const double needed_nm = neededTorque_nm(duration_s, target_radps);
  std::optional<double> fixed_nm;
  if (std::abs(needed_nm) > limit_nm) fixed_nm = std::copysign(limit_nm, needed_nm);
  const bool right = fixed_nm == fixed_torque_nm;
  fixed_torque_nm = fixed_nm;
  return right;
}

void WheelContact::spin(double duration_s, double target_radps) {
  const double limit_nm = description.max_torque_nm;
  const double torque_nm =
      std::clamp(neededTorque_nm(duration_s, target_radps), -limit_nm, limit_nm);
  acceleration_radps2 = (torque_nm - description.radius_m * traction_n()) / inertia_kgm2;
  speed_radps += duration_s * acceleration_radps2;
  angle_rad += duration_s * speed_radps;
  load_n =
      touches_ground ? std::max(0.0, toEigen(force.f1).dot(toEigen(contact.geom.normal))) : 0.0;
}

}  // namespace ramscout_sim
