// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/simulation_parameters.hpp"

namespace ramscout_sim {

const ram_parameters::ParameterTable<SimulationParameters>& SimulationParameters::table() {
  using namespace ram_parameters;
  using P = SimulationParameters;
  static const auto table =
      ParameterTable<P>()
          .add("seed", &P::seed, "", atLeast(0),
               "All random numbers depend on it and on nothing else.")
          .add("physics_rate_hz", &P::physics_rate_hz, "1/s", within(100.0, 10000.0),
               "Steps of the rigid-body physics. 1000 is exact to 1e-5 in driven distance, 400 to "
               "1e-4.")
          .add("odometry_rate_hz", &P::odometry_rate_hz, "1/s", positive(),
               "Rate of odom, its tf, joint_states and ground_truth.")
          .rule(&P::odometry_rate_hz, "<= physics_rate_hz",
                [](const P& p) { return p.odometry_rate_hz <= p.physics_rate_hz; })
          .addChoice("instruction_set", &P::instruction_set,
                     {{"sse4.2", InstructionSet::kSse42},
                      {"avx", InstructionSet::kAvx},
                      {"avx2", InstructionSet::kAvx2},
                      {"avx512", InstructionSet::kAvx512}},
                     "The widest vector instructions that ray casting uses (a processor without "
                     "them uses what it has). Only in worlds with meshes or maps do scans depend "
                     "on it: they are the same to the bit on processors with the chosen set. "
                     "avx512 casts a fifth more rays than avx2, in meshes almost twice as many.")
          .heading("Limits of what the motors are asked for")
          .section("drive", &P::drive, DriveParameters::table())
          .heading("How the real robot differs from what its odometry assumes")
          .section("odometry", &P::odometry, OdometryParameters::table())
          .heading("The lidar")
          .section("lidar", &P::lidar, LidarParameters::table())
          .expert("Faults")
          .add("push_tries", &P::push_tries, "", within(1, 1000),
               "How many shares of its way the fault `push` tries, the whole first, until one ends "
               "in the free.")
          .add("payload_density_kgpm3", &P::payload_density_kgpm3, "kg/m^3", positive(),
               "Of the cube that the fault `payload` puts on the chassis.")
          .expert("Rigid-body physics (ODE)")
          .section("physics", &P::physics, PhysicsParameters::table())
          .expert("People and doors")
          .section("actors", &P::actors, ActorParameters::table())
          .expert("Driver of a tour")
          .section("tour_driver", &P::tour_driver, TourDriverParameters::table());
  return table;
}

SimulationParameters readSimulationParameters(ram_parameters::ParameterReader& reader) {
  SimulationParameters p;
  reader.read("lidar/preset", p.lidar.preset);
  p.lidar = lidarPreset(p.lidar.preset);
  SimulationParameters::table().read(reader, p);
  p.validate();
  return p;
}

}  // namespace ramscout_sim
