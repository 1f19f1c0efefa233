// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "ramscout_sim/lidar.hpp"
#include "ramscout_sim/office.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/ray_caster.hpp"

namespace ramscout_sim {
namespace {

double residentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0.0;
  double resident = 0.0;
  statm >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

RobotDescription shippedRobot() {
  return readRobot(std::string(CONFIG_FOLDER) + "/robots/ramscout.urdf");
}

void writeTriangle(std::ostream& stream, const std::array<Eigen::Vector3f, 3>& corners) {
  std::array<float, 12> numbers = {};
  for (std::size_t i = 0; i < 9; ++i)
    numbers[3 + i] = corners[i / 3][static_cast<Eigen::Index>(i % 3)];
  stream.write(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
  stream.write("\0", 2);
}

/// The boxes of an office as binary STL. \return the number of triangles
unsigned writeStl(const World& world, const std::string& path) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(std::string(80, ' ').c_str(), 80);
  unsigned count = 0;
  for (const Solid& solid : world.solids) count += solid.shape == Shape::kBox ? 24 : 0;
  stream.write(reinterpret_cast<const char*>(&count), 4);
  for (const Solid& solid : world.solids) {
    if (solid.shape != Shape::kBox) continue;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-0.5, 0.5}) {
        const auto corner = [&](double u, double v) {
          Eigen::Vector3d p = Eigen::Vector3d::Zero();
          p[axis] = side * solid.size_m[axis];
          p[(axis + 1) % 3] = u * solid.size_m[(axis + 1) % 3];
          p[(axis + 2) % 3] = v * solid.size_m[(axis + 2) % 3];
          return Eigen::Vector3f((solid.world_from_solid * p).cast<float>());
        };
        const std::array<Eigen::Vector3f, 4> rim = {corner(-0.5, -0.5), corner(0.5, -0.5),
                                                    corner(0.5, 0.5), corner(-0.5, 0.5)};
        for (std::size_t k = 0; k < 4; ++k)
          writeTriangle(stream, {rim[k], rim[(k + 1) % 4], corner(0.0, 0.0)});
      }
    }
  }
  return count;
}

/// 59 x 48 m.
Office meshedOffice() {
  OfficeParameters parameters;
  parameters.blocks_along_x = 3;
  parameters.blocks_along_y = 3;
  return generateOffice(parameters);
}

std::string meshPath() {
  return (std::filesystem::temp_directory_path() / "ramscout_sim_world_benchmark.stl").string();
}

/// From the file to a robot that stands and sees: about 12,000 triangles.
void loadBuildingMesh(benchmark::State& state) {
  const Office office = meshedOffice();
  const std::string path = meshPath();
  const unsigned triangles = writeStl(office.world, path);
  const double before_mb = residentMegabytes();
  double added_mb = 0.0;
  for (auto _ : state) {
    World world = readWorld(path);
    world.start = office.world.start;
    const RayCaster caster(world);
    const Physics physics(shippedRobot(), world, world.start);
    benchmark::DoNotOptimize(physics.worldFromBase());
    added_mb = std::max(added_mb, residentMegabytes() - before_mb);
  }
  std::filesystem::remove(path);
  state.counters["triangles"] = triangles;
  state.counters["added_MB"] = added_mb;
  state.counters["total_MB"] = residentMegabytes();
}
BENCHMARK(loadBuildingMesh)->Unit(benchmark::kMillisecond);

/// One scan in that mesh, with AVX2 (2) or AVX-512 (3).
void scanMesh(benchmark::State& state) {
  const Office office = meshedOffice();
  writeStl(office.world, meshPath());
  const RayCaster caster(readWorld(meshPath()), static_cast<InstructionSet>(state.range(0)));
  std::filesystem::remove(meshPath());
  const Lidar lidar(LidarParameters(), 1);
  const SensorPath path{{0},
                        {Eigen::Translation3d(0.0, 0.0, 0.37) * toIsometry(office.world.start)}};
  std::uint64_t scan = 0;
  for (auto _ : state) benchmark::DoNotOptimize(lidar.measure(0, scan++, path, caster));
}
BENCHMARK(scanMesh)
    ->Arg(static_cast<int>(InstructionSet::kAvx2))
    ->Arg(static_cast<int>(InstructionSet::kAvx512))
    ->Unit(benchmark::kMicrosecond);

/// One scan from the first corridor of an office with so many blocks a side.
void scanOffice(benchmark::State& state) {
  OfficeParameters parameters;
  parameters.blocks_along_x = static_cast<int>(state.range(0));
  parameters.blocks_along_y = static_cast<int>(state.range(0));
  const Office office = generateOffice(parameters);
  const RayCaster caster(office.world);
  const Lidar lidar(LidarParameters(), 1);
  const SensorPath path{{0},
                        {Eigen::Translation3d(0.0, 0.0, 0.37) * toIsometry(office.world.start)}};
  std::uint64_t scan = 0;
  for (auto _ : state) benchmark::DoNotOptimize(lidar.measure(0, scan++, path, caster));
  state.counters["area_m2"] = parameters.length_m() * parameters.depth_m();
  state.counters["solids"] = static_cast<double>(office.world.solids.size());
}
BENCHMARK(scanOffice)->Arg(1)->Arg(3)->Arg(10)->Arg(30)->Unit(benchmark::kMicrosecond);

/// What each effect adds to a scan: 0 none, 1 drop-outs, 2 mixed pixels, 3 glass fronts, 4 all; and
/// 5: none, but 20 people.
void scanWithEffects(benchmark::State& state) {
  OfficeParameters parameters;
  const auto effect = state.range(0);
  if (effect == 3 || effect == 4) parameters.glass_front_share = 0.5;
  const Office office = generateOffice(parameters);
  const RayCaster caster(office.world);
  LidarParameters p;
  if (effect == 1 || effect == 4) p.half_detection_range_m = 60.0;
  if (effect == 2 || effect == 4) p.beam_divergence_rad = 0.0013;
  const Lidar lidar(p, 1);
  const SensorPath path{{0},
                        {Eigen::Translation3d(0.0, 0.0, 0.37) * toIsometry(office.world.start)}};
  std::vector<Solid> moving;
  for (int i = 0; effect == 5 && i < 60; ++i) {
    Solid leg;
    leg.shape = Shape::kCylinder;
    leg.size_m = {0.16, 0.16, 0.85};
    leg.world_from_solid.translate(Eigen::Vector3d(2.0 + 0.5 * i, 6.0 + 0.3 * (i % 5), 0.425));
    moving.push_back(leg);
  }
  std::uint64_t scan = 0;
  for (auto _ : state) benchmark::DoNotOptimize(lidar.measure(0, scan++, path, caster, moving));
}
BENCHMARK(scanWithEffects)->DenseRange(0, 5)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace ramscout_sim
