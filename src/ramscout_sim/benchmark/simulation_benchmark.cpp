// SPDX-License-Identifier: BSD-3-Clause
// Rays per second beside ODE's own, physics steps per second, and the whole core in simulated
// seconds per second. Items are rays, steps, and simulated seconds.
#include <algorithm>
#include <optional>

#include <benchmark/benchmark.h>
#include <ode/ode.h>

#include "ramscout_sim/office.hpp"
#include "ramscout_sim/simulation.hpp"

namespace ramscout_sim {
namespace {

RobotDescription robot() {
  return readRobot(CONFIG_FOLDER "/robots/ramscout.urdf");
}

Office office(int blocks) {
  OfficeParameters parameters;
  parameters.blocks_along_x = blocks;
  parameters.blocks_along_y = blocks;
  return generateOffice(parameters);
}

/// Scans of a UTM-30LX at every metre of the office's tour.
std::vector<Rays> scansAlong(const Tour& tour) {
  const Lidar lidar({}, 1);
  std::vector<Rays> scans;
  for (std::size_t i = 1; i < tour.waypoints_m.size() && scans.size() < 60; ++i) {
    const Eigen::Vector2d leg = tour.waypoints_m[i] - tour.waypoints_m[i - 1];
    for (double way_m = 0.0; way_m < leg.norm() && scans.size() < 60; way_m += 1.0) {
      const Eigen::Vector2d at = tour.waypoints_m[i - 1] + way_m * leg.normalized();
      const Eigen::Isometry3d pose =
          toIsometry({at.x(), at.y(), way_m}) * Eigen::Translation3d(0.0, 0.0, 0.37);
      scans.push_back(lidar.rays(0, {{0}, {pose}}));
    }
  }
  return scans;
}

void castRays(benchmark::State& state) {
  const Office building = office(static_cast<int>(state.range(0)));
  const RayCaster caster(building.world, static_cast<InstructionSet>(state.range(1)));
  const auto scans = scansAlong(building.tour);
  std::int64_t rays = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    const Rays& scan = scans[next++ % scans.size()];
    benchmark::DoNotOptimize(caster.cast(scan, 30.0F));
    rays += static_cast<std::int64_t>(scan.size());
  }
  state.SetItemsProcessed(rays);
  state.counters["solids"] = static_cast<double>(building.world.solids.size());
}
BENCHMARK(castRays)
    ->ArgsProduct({{1, 2, 3, 4, 8},
                   {static_cast<int>(InstructionSet::kSse42),
                    static_cast<int>(InstructionSet::kAvx2),
                    static_cast<int>(InstructionSet::kAvx512)}})
    ->ArgNames({"blocks", "set"});

/// ODE's rays in its best space, for comparison.
void castRaysWithOde(benchmark::State& state) {
  const Office building = office(static_cast<int>(state.range(0)));
  const auto scans = scansAlong(building.tour);
  dInitODE2(0);
  const Eigen::AlignedBox3d bounds = boundsOf(building.world);
  const Eigen::Vector3d center = bounds.center();
  const Eigen::Vector3d extents = bounds.sizes();
  const dVector3 ode_center = {center.x(), center.y(), center.z()};
  const dVector3 ode_extents = {extents.x(), extents.y(), extents.z()};
  const dSpaceID space = dQuadTreeSpaceCreate(nullptr, ode_center, ode_extents, 6);
  for (const Solid& solid : building.world.solids) {
    const dGeomID geom = dCreateBox(space, solid.size_m.x(), solid.size_m.y(), solid.size_m.z());
    const Eigen::Vector3d p = solid.world_from_solid.translation();
    const Eigen::Quaterniond q(solid.world_from_solid.linear());
    const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
    dGeomSetPosition(geom, p.x(), p.y(), p.z());
    dGeomSetQuaternion(geom, quaternion);
  }
  const dGeomID ode_ray = dCreateRay(nullptr, 30.0);
  std::int64_t rays = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    const Rays& scan = scans[next++ % scans.size()];
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const Ray ray = scan[i];
      dGeomRaySet(ode_ray, ray.origin_m.x(), ray.origin_m.y(), ray.origin_m.z(), ray.direction.x(),
                  ray.direction.y(), ray.direction.z());
      double nearest_m = 30.0;
      dSpaceCollide2(ode_ray, reinterpret_cast<dGeomID>(space), &nearest_m,
                     [](void* nearest, dGeomID a, dGeomID b) {
                       dContactGeom contact;
                       if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0) {
                         *static_cast<double*>(nearest) =
                             std::min(*static_cast<double*>(nearest), contact.depth);
                       }
                     });
      benchmark::DoNotOptimize(nearest_m);
      ++rays;
    }
  }
  state.SetItemsProcessed(rays);
  dGeomDestroy(ode_ray);
  dSpaceDestroy(space);
}
BENCHMARK(castRaysWithOde)->Arg(1)->Arg(2)->Arg(3)->Arg(4)->Arg(8)->ArgName("blocks");

void stepPhysics(benchmark::State& state) {
  const Office building = office(2);
  Physics physics(robot(), building.world, building.world.start);
  for (auto _ : state) physics.step(1e-3, {{2.0, -2.0}, {}});
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(stepPhysics);

/// Physics at the given rate, UTM-30LX at 40 Hz with noise and rolling scan, odometry at 100 Hz,
/// along a tour.
void simulateOneSecond(benchmark::State& state) {
  const Office building = office(2);
  SimulationParameters parameters;
  parameters.physics_rate_hz = static_cast<double>(state.range(0));
  parameters.instruction_set =
      state.range(1) == 512 ? InstructionSet::kAvx512 : InstructionSet::kAvx2;
  Simulation simulation(parameters, robot(), building.world, building.tour);
  for (auto _ : state) {
    const std::int64_t end_ns = simulation.now_ns() + 1'000'000'000;
    while (simulation.now_ns() < end_ns) benchmark::DoNotOptimize(simulation.step());
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(simulateOneSecond)
    ->ArgsProduct({{1000, 400}, {2, 512}})
    ->ArgNames({"hz", "avx"})
    ->Unit(benchmark::kMillisecond);

/// The same at 1 kHz in buildings of growing size.
void simulateBuilding(benchmark::State& state) {
  const Office building = office(static_cast<int>(state.range(0)));
  Simulation simulation({}, robot(), building.world, building.tour);
  for (auto _ : state) {
    const std::int64_t end_ns = simulation.now_ns() + 1'000'000'000;
    while (simulation.now_ns() < end_ns) benchmark::DoNotOptimize(simulation.step());
  }
  state.SetItemsProcessed(state.iterations());
  const Eigen::AlignedBox3d bounds = boundsOf(building.world);
  state.counters["solids"] = static_cast<double>(building.world.solids.size());
  state.counters["area_m2"] = bounds.sizes().x() * bounds.sizes().y();
}
BENCHMARK(simulateBuilding)
    ->Arg(1)
    ->Arg(4)
    ->Arg(16)
    ->ArgName("blocks")
    ->Unit(benchmark::kMillisecond);

/// Against a wall at full speed, back and on at another angle.
void ramWalls(benchmark::State& state) {
  World room;
  room.solids = {makeWall({0, 0}, {6, 0}, 0.2, 2.5), makeWall({6, 0}, {6, 4}, 0.2, 2.5),
                 makeWall({6, 4}, {0, 4}, 0.2, 2.5), makeWall({0, 4}, {0, 0}, 0.2, 2.5)};
  room.start = {3.0, 2.0, 0.3};
  SimulationParameters parameters;
  Simulation simulation(parameters, robot(), room, std::nullopt);
  std::int64_t touching = 0;
  std::int64_t steps = 0;
  for (auto _ : state) {
    for (int i = 0; i < 1000; ++i, ++steps) {
      const std::int64_t phase = steps / 2500;
      simulation.command(
          {phase % 5 == 4 ? -1.5 : 1.5, 0.0, 0.4 * static_cast<double>(phase % 3 - 1)});
      benchmark::DoNotOptimize(simulation.step());
      touching += simulation.inCollision() ? 1 : 0;
    }
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["touching"] = static_cast<double>(touching) / static_cast<double>(steps);
}
BENCHMARK(ramWalls)->Unit(benchmark::kMillisecond);

void loadWorld(benchmark::State& state) {
  for (auto _ : state) {
    const World world = readWorld(CONFIG_FOLDER "/worlds/office.yaml");
    benchmark::DoNotOptimize(RayCaster(world));
  }
}
BENCHMARK(loadWorld)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ramscout_sim
