// SPDX-License-Identifier: BSD-3-Clause
// Cost of aligning scans, of the dense search and of the graph, and how it grows.
#include <benchmark/benchmark.h>

#include "ram_slam/pose_graph/pose_graph.hpp"
#include "ram_slam/scan_matching/correlative_search.hpp"
#include "ram_slam/scan_matching/laser_odometry.hpp"
#include "ram_slam/scan_matching/scan_matcher.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"

#include "../../test/scan_matching/walls.hpp"

namespace ram_slam {
namespace {

Walls room() {
  return outline({{-4, -3}, {6, -3}, {6, 2}, {2, 2}, {2, 5}, {-4, 5}}) +
         rectangle(3.0, -1.0, 3.5, -0.5);
}

LaserScan scanAt(const Pose2& map_from_laser, std::int64_t beams, std::int64_t stamp_ns = 1) {
  TestLaser laser;
  laser.beam_count = static_cast<std::size_t>(beams);
  laser.range_deviation_m = 0.01;
  return scanWalls(room(), map_from_laser, stamp_ns, laser);
}

void matchTwoScans(benchmark::State& state) {
  const SurfaceScan target = extractSurfaces(scanAt({}, state.range(0)), {});
  const SurfaceScan source = extractSurfaces(scanAt({0.1, 0.05, 0.05}, state.range(0), 2), {});
  ScanMatcherParameters parameters;
  parameters.max_points = 10000;
  for (auto _ : state)
    benchmark::DoNotOptimize(matchScan(source, {{&target, {}}}, {}, {}, parameters));
  state.SetComplexityN(state.range(0));
}
BENCHMARK(matchTwoScans)->RangeMultiplier(2)->Range(128, 2048)->Complexity();

void extractLines(benchmark::State& state) {
  const LaserScan scan = scanAt({}, state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(extractSurfaces(scan, {}));
  state.SetComplexityN(state.range(0));
}
BENCHMARK(extractLines)->RangeMultiplier(2)->Range(128, 2048)->Complexity(benchmark::oN);

/// Search of a place in a window of so many decimetres to each side.
void searchLoop(benchmark::State& state) {
  std::vector<Eigen::Vector2f> points;
  for (const SurfacePoint& point : extractSurfaces(scanAt({}, 361), {}).points)
    points.emplace_back(point.x_m, point.y_m);
  SearchWindow window;
  window.distance_m = 0.1 * static_cast<double>(state.range(0));
  window.angle_rad = 0.3;
  window.angle_step_rad = 0.015;
  for (auto _ : state) {
    const LikelihoodPyramid pyramid(points, 0.1, 0.1, 5);
    benchmark::DoNotOptimize(searchPose(pyramid, points, {0.3, 0.2, 0.1}, window, 0.45));
  }
  state.SetComplexityN(state.range(0));
}
BENCHMARK(searchLoop)
    ->RangeMultiplier(2)
    ->Range(4, 64)
    ->Complexity()
    ->Unit(benchmark::kMillisecond);

/// A chain of so many poses with a closure each ten.
void solveGraph(benchmark::State& state) {
  PoseGraph graph;
  const auto count = static_cast<std::size_t>(state.range(0));
  const Pose2 step{0.3, 0.0, 0.02};
  graph.map_from_node.push_back({});
  for (std::size_t i = 1; i < count; ++i) {
    graph.map_from_node.push_back(graph.map_from_node.back() * step);
    PoseEdge edge;
    edge.from = i - 1;
    edge.to = i;
    edge.from_from_to = {0.3, 0.001, 0.0201};
    edge.information *= 1e4;
    graph.edges.push_back(edge);
  }
  for (std::size_t i = 0; i + 314 < count; i += 10) {
    PoseEdge edge;
    edge.from = i;
    edge.to = i + 314;
    edge.from_from_to = graph.map_from_node[i].inverse() * graph.map_from_node[i + 314];
    edge.information *= 1e3;
    edge.may_be_false = true;
    graph.edges.push_back(edge);
  }
  for (auto _ : state) benchmark::DoNotOptimize(solvePoseGraph(graph, {}));
  state.SetComplexityN(state.range(0));
}
BENCHMARK(solveGraph)
    ->RangeMultiplier(2)
    ->Range(512, 8192)
    ->Complexity()
    ->Unit(benchmark::kMillisecond);

/// Laser odometry scan by scan about a room.
void laserOdometry(benchmark::State& state) {
  std::vector<LaserScan> scans;
  for (int i = 0; i < 100; ++i)
    scans.push_back(scanAt({0.02 * i - 1.0, 0.0, 0.01 * i}, state.range(0), 100000000LL * (i + 1)));
  for (auto _ : state) {
    LaserOdometry odometry{LaserOdometryParameters()};
    for (const LaserScan& scan : scans)
      benchmark::DoNotOptimize(odometry.update(scan, {}, std::nullopt));
  }
  state.SetItemsProcessed(state.iterations() * 100);
}
BENCHMARK(laserOdometry)->Arg(181)->Arg(361)->Arg(1081)->Unit(benchmark::kMillisecond);

/// Refinement of so many key scans that all see one room.
void refineKeyScans(benchmark::State& state) {
  std::vector<KeyScan> key_scans;
  std::vector<PoseEdge> motion;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    const double t = 0.1 * static_cast<double>(i);
    const Pose2 pose{std::sin(t), 0.5 * std::sin(2.0 * t), 0.3 * t};
    KeyScan key;
    key.surfaces = extractSurfaces(scanAt(pose, 361, i + 1), {});
    key.map_from_laser = pose;
    key_scans.push_back(std::move(key));
  }
  for (std::size_t i = 1; i < key_scans.size(); ++i) {
    PoseEdge edge;
    edge.from = i - 1;
    edge.to = i;
    edge.from_from_to = key_scans[i - 1].map_from_laser.inverse() * key_scans[i].map_from_laser;
    motion.push_back(edge);
  }
  for (auto _ : state) benchmark::DoNotOptimize(refineJointly(key_scans, motion, {}, {}));
  state.SetComplexityN(state.range(0));
}
BENCHMARK(refineKeyScans)
    ->RangeMultiplier(2)
    ->Range(64, 1024)
    ->Complexity()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ram_slam
