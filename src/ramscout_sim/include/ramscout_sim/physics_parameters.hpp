// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_parameters/parameter_table.hpp"

namespace ramscout_sim {

/// How stiff contacts are, how often they are computed again, and where ODE searches for them.
/// Softness is ODE's constraint force mixing (CFM) [m/(N s)]: a contact under the load N sinks in
/// by N * step * softness / error_reduction.
struct PhysicsParameters {
  /// Share of a penetration that is corrected in one step (ODE's ERP).
  double error_reduction = 0.2;
  double max_correcting_speed_mps = 0.1;
  /// The floor is nearly rigid under the wheels; the casters are sprung a little softer, so that
  /// the wheels carry most of the weight although four points on a plane share it.
  double wheel_softness = 1e-6;
  double caster_softness = 1e-5;
  double solid_softness = 1e-5;
  /// Of friction under the wheels: two wheels on one axle resist the same motion.
  double friction_softness = 1e-9;
  double solid_friction = 0.3;
  /// ODE's solver gives up (and prints so) if two wheels reach their friction limits at the very
  /// same moment, as those of a symmetric robot do: each wheel has a little more than the one
  /// before.
  double wheel_tie_breaker = 1e-6;
  int motor_trials = 4;
  int contacts_per_pair = 3;
  int max_contacts = 8;
  /// How far around the robot solids are looked for, one distance after the other, and how many
  /// steps that is not repeated where one is near.
  std::vector<double> look_ahead_m = {0.5, 0.1, 0.02};
  int steps_near_solid = 20;
  /// Cosine of the tilt from which on the chassis may touch the floor.
  double lying_cosine = 0.99;
  /// Sum of coordinates [m] and speeds [m/s] from which on a run counts as diverged.
  double diverged_sum = 1e6;
  /// Free start poses are looked for on rings around the wanted one.
  double start_ring_m = 0.1;
  int start_rings = 100;

  static const ram_parameters::ParameterTable<PhysicsParameters>& table();
};

}  // namespace ramscout_sim
