// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <benchmark/benchmark.h>

#include "ram_slam/occupancy/key_scan_map.hpp"
#include "ram_slam/occupancy/occupancy_mapper.hpp"

namespace ram_slam {
namespace {

/// Half a turn of beams in a corridor 3 m wide with a door every 6 m, up to 20 m long.
LaserScan corridorScan(std::int64_t beams, std::int64_t stamp_ns) {
  LaserScan scan;
  scan.stamp_ns = stamp_ns;
  scan.angle_min_rad = -M_PI_2;
  scan.angle_increment_rad = M_PI / static_cast<double>(beams);
  scan.range_max_m = 80.0F;
  for (std::int64_t i = 0; i < beams; ++i) {
    const double angle_rad = scan.bearing_rad(static_cast<std::size_t>(i));
    const double wall_m = 1.5 / std::max(1e-3, std::abs(std::sin(angle_rad)));
    const bool door = std::fmod(wall_m * std::cos(angle_rad), 6.0) < 1.0;
    scan.ranges_m.push_back(static_cast<float>(std::min(door ? 2.5 * wall_m : wall_m, 20.0)));
  }
  return scan;
}

/// Along a square of 30 m sides.
Pose2 poseAlongTour(std::int64_t k) {
  const double driven_m = 0.1 * static_cast<double>(k);
  const auto side = static_cast<std::int64_t>(driven_m / 30.0);
  const Pose2 corners[] = {{0, 0, 0}, {30, 0, M_PI_2}, {30, 30, M_PI}, {0, 30, -M_PI_2}};
  return corners[side % 4] * Pose2{driven_m - 30.0 * static_cast<double>(side), 0.0, 0.0};
}

void addScan(benchmark::State& state) {
  OccupancyMapper mapper((OccupancyMapperParameters()));
  const LaserScan scan = corridorScan(state.range(0), 0);
  std::int64_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(mapper.add(scan, poseAlongTour(k++ % 1200)));
}
BENCHMARK(addScan)->Arg(180)->Arg(360)->Arg(1081)->Unit(benchmark::kMicrosecond);

void removeAndAddScan(benchmark::State& state) {
  OccupancyMapper mapper((OccupancyMapperParameters()));
  const LaserScan scan = corridorScan(360, 0);
  for (std::int64_t k = 0; k < 1200; ++k) mapper.add(scan, poseAlongTour(k));
  std::int64_t k = 0;
  for (auto _ : state) {
    mapper.remove(scan, poseAlongTour(k % 1200));
    mapper.add(scan, poseAlongTour(k++ % 1200));
  }
}
BENCHMARK(removeAndAddScan)->Unit(benchmark::kMicrosecond);

/// Re-rendering after a correction of every scan; the argument is the number of key scans.
void correctTrajectory(benchmark::State& state) {
  KeyScanMap map((OccupancyMapperParameters()));
  Trajectory here;
  Trajectory there;
  for (std::int64_t k = 0; k < state.range(0); ++k) {
    map.add(corridorScan(360, k + 1), poseAlongTour(k), {});
    here.push_back({k + 1, poseAlongTour(k)});
    there.push_back({k + 1, Pose2{0.1, 0.05, 0.01} * poseAlongTour(k)});
  }
  map.draw();
  bool moved = false;
  for (auto _ : state) {
    moved = !moved;
    benchmark::DoNotOptimize(map.correct(moved ? there : here));
    map.draw();
  }
  state.SetComplexityN(state.range(0));
}
BENCHMARK(correctTrajectory)
    ->RangeMultiplier(2)
    ->Range(128, 2048)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();

/// A whole grid; the argument is the number of key scans that made the map.
void drawGrid(benchmark::State& state) {
  OccupancyMapper mapper((OccupancyMapperParameters()));
  for (std::int64_t k = 0; k < state.range(0); ++k)
    mapper.add(corridorScan(360, 0), poseAlongTour(k));
  for (auto _ : state) benchmark::DoNotOptimize(mapper.grid());
  state.counters["cells"] = static_cast<double>(mapper.grid().cells.size());
}
BENCHMARK(drawGrid)->Arg(1)->Arg(300)->Arg(1200)->Unit(benchmark::kMicrosecond);

/// Bringing a grid up to date after one scan in a large map.
void refreshGrid(benchmark::State& state) {
  OccupancyMapper mapper((OccupancyMapperParameters()));
  const LaserScan scan = corridorScan(360, 0);
  for (std::int64_t k = 0; k < 1200; ++k) mapper.add(scan, poseAlongTour(k));
  OccupancyGrid grid = mapper.grid();
  std::uint64_t revision = mapper.revision();
  std::int64_t k = 0;
  for (auto _ : state) {
    state.PauseTiming();
    mapper.add(scan, poseAlongTour(k++ % 1200));
    state.ResumeTiming();
    benchmark::DoNotOptimize(mapper.refresh(grid, revision));
    revision = mapper.revision();
  }
}
BENCHMARK(refreshGrid)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace ram_slam
