// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "ramscout_sim/physics_parameters.hpp"

#include "ground.hpp"
#include "ode_objects.hpp"

namespace ramscout_sim {

/// A wheel, how it spins, and its contact with the ground in the step under way.
struct WheelContact {
  Wheel description;
  Eigen::Vector3d center_in_body_m = Eigen::Vector3d::Zero();
  double inertia_kgm2 = 0.0;  // about the axle
  double friction_share = 1.0;
  double softness = 0.0;  // ODE's CFM: of the contact, and of its friction
  double friction_softness = 0.0;
  double steering_rad = 0.0;
  double angle_rad = 0.0;
  double speed_radps = 0.0;
  double acceleration_radps2 = 0.0;
  double load_n = 0.0;
  /// What the motor gives whatever the speed; nothing: it holds its speed.
  std::optional<double> fixed_torque_nm;

  bool touches_ground = false;
  Eigen::Vector3d rolling = Eigen::Vector3d::UnitX();  // world axes
  dContact contact = {};
  dJointFeedback force = {};

  /// \param number  of wheels before it
  WheelContact(const Wheel& wheel, std::size_t number, const PhysicsParameters& parameters);

  Eigen::Vector3d axleInBody() const;
  /// Finds the contact, from where the wheel is now.
  void touch(const Ground& ground,
             const Eigen::Vector3d& center_m,
             const Eigen::Vector3d& axle_in_world,
             double friction);
  /// Contact speed = r w' with w' = target, or w + h / I (torque - r traction).
  void drive(double duration_s, double target_radps);
  /// Whether the motor did in the step as was assumed; otherwise notes what to assume instead.
  bool didAsAssumed(double duration_s, double target_radps);
  /// Takes over the step's result.
  void spin(double duration_s, double target_radps);

private:
  double traction_n() const { return touches_ground ? toEigen(force.f1).dot(rolling) : 0.0; }
  double neededTorque_nm(double duration_s, double target_radps) const;
};

}  // namespace ramscout_sim
