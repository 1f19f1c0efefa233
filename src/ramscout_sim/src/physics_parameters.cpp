// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/physics_parameters.hpp"

#include <algorithm>

namespace ramscout_sim {
namespace {

using namespace ram_parameters;
using P = PhysicsParameters;

void addContacts(ParameterTable<P>& table) {
  table
      .add("error_reduction", &P::error_reduction, "", aboveUpTo(0.0, 1.0),
           "Share of a penetration that is corrected in one step (ODE's ERP).")
      .add("max_correcting_speed_mps", &P::max_correcting_speed_mps, "m/s", positive(),
           "Fastest that a penetration is corrected.")
      .add("wheel_softness", &P::wheel_softness, "m/(N s)", atLeast(0.0),
           "Constraint force mixing (ODE's CFM) of contacts between wheels and floor.")
      .add("caster_softness", &P::caster_softness, "m/(N s)", atLeast(0.0),
           "The same for casters; softer than wheels, so that these carry most of the weight.")
      .add("solid_softness", &P::solid_softness, "m/(N s)", atLeast(0.0),
           "The same for the chassis against solids.")
      .add("friction_softness", &P::friction_softness, "m/(N s)", positive(),
           "The same for friction under wheels; two on one axle resist the same motion.")
      .add("solid_friction", &P::solid_friction, "", atLeast(0.0),
           "Coulomb friction between chassis and solids.")
      .add("wheel_tie_breaker", &P::wheel_tie_breaker, "", atLeast(0.0),
           "Each wheel's friction limit exceeds that of the one before by this share; with equal "
           "limits ODE's solver fails.")
      .add("contacts_per_pair", &P::contacts_per_pair, "", within(1, 100),
           "Most contacts between the chassis and one solid.")
      .add("max_contacts", &P::max_contacts, "", within(1, 1000),
           "Most contacts between the chassis and all solids.")
      .add("lying_cosine", &P::lying_cosine, "", within(-1.0, 1.0),
           "Cosine of the tilt from which on the chassis may touch the floor.");
}

void addSearch(ParameterTable<P>& table) {
  table
      .add("motor_trials", &P::motor_trials, "", atLeast(1),
           "Most computations of a step until each motor's torque is on the right side of its "
           "limit.")
      .add("look_ahead_m", &P::look_ahead_m,
           "How far around the chassis [m] solids are looked for, one distance after the other.")
      .rule(&P::look_ahead_m, "positive and descending",
            [](const P& p) {
              return std::is_sorted(p.look_ahead_m.rbegin(), p.look_ahead_m.rend()) &&
                     (p.look_ahead_m.empty() || p.look_ahead_m.back() > 0.0);
            })
      .add("steps_near_solid", &P::steps_near_solid, "", atLeast(0),
           "Steps without another search where a solid is near.")
      .add("diverged_sum", &P::diverged_sum, "", positive(),
           "Sum of coordinates [m] and speeds [m/s] from which on a run counts as diverged and "
           "ends.")
      .add("start_ring_m", &P::start_ring_m, "m", positive(),
           "Where the start is inside a solid, a free pose is looked for on rings this far apart.")
      .add("start_rings", &P::start_rings, "", within(0, 1000), "Number of these rings.");
}

}  // namespace

const ParameterTable<PhysicsParameters>& PhysicsParameters::table() {
  static const auto table = [] {
    ParameterTable<P> rows;
    addContacts(rows);
    addSearch(rows);
    return rows;
  }();
  return table;
}

}  // namespace ramscout_sim
