// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include <benchmark/benchmark.h>

#include "ramscout_kinematics/kinematics.hpp"

#include "../test/drives.hpp"

namespace ramscout_kinematics {
namespace {

constexpr double kOdometryPeriodS = 0.01;
constexpr double kScanPeriodS = 0.1;

/// 10 s of odometry at 100 Hz, asked about one scan interval of 10 samples.
void motionOfOneScan(benchmark::State& state) {
  Kinematics kinematics{KinematicsParameters()};
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 10.0, kOdometryPeriodS));
  for ([[maybe_unused]] const auto iteration : state) {
    benchmark::DoNotOptimize(kinematics.motion(after(5.0), after(5.0 + kScanPeriodS)));
  }
}
BENCHMARK(motionOfOneScan);

void sampleParticles(benchmark::State& state) {
  Kinematics kinematics{KinematicsParameters()};
  addAll(kinematics, drive({1.0, 0.0, 0.3}, 10.0, kOdometryPeriodS));
  const std::vector<ram_slam::Pose2> particles(static_cast<std::size_t>(state.range(0)));
  std::uint64_t seed = 0;
  for ([[maybe_unused]] const auto iteration : state) {
    benchmark::DoNotOptimize(
        kinematics.sample(particles, after(5.0), after(5.0 + kScanPeriodS), ++seed));
  }
  state.SetComplexityN(state.range(0));
}
BENCHMARK(sampleParticles)->RangeMultiplier(10)->Range(10, 10000)->Complexity(benchmark::oN);

void addOneSample(benchmark::State& state) {
  Kinematics kinematics{KinematicsParameters()};
  double time_s = 0.0;
  for ([[maybe_unused]] const auto iteration : state) {
    time_s += kOdometryPeriodS;
    benchmark::DoNotOptimize(kinematics.add({after(time_s), {time_s, 0.0, 0.0}}));
  }
}
BENCHMARK(addOneSample);

}  // namespace
}  // namespace ramscout_kinematics

BENCHMARK_MAIN();
