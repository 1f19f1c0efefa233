// SPDX-License-Identifier: BSD-3-Clause
// Time of detection with description for one scan, over random places in the three kinds of worlds.
#include <benchmark/benchmark.h>

#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

#include "../test/random_world.hpp"

namespace {

using namespace ramscout_feature_detector;

constexpr int kScans = 50;
constexpr double kNoiseM = 0.01;

std::vector<ram_slam::LaserScan> scans(RandomWorld::Kind kind, int beams) {
  std::vector<ram_slam::LaserScan> result;
  const RandomWorld random_world(kind, 7);
  const PolygonWorld world = random_world.walls();
  for (int i = 0; i < kScans; ++i) {
    ram_slam::Random random(7, i);
    const ram_slam::Pose2 pose = random_world.freePose(random);
    result.push_back(
        world.scan(pose, kNoiseM, random, beams, -0.75 * M_PI, 1.5 * M_PI / (beams - 1)));
  }
  return result;
}

void run(benchmark::State& state,
         RandomWorld::Kind kind,
         int beams,
         const FeatureDetectorParameters& parameters) {
  const auto inputs = scans(kind, beams);
  const FeatureDetector detector(parameters);
  std::size_t next = 0;
  std::size_t features = 0;
  for (auto _ : state) {
    features += detector.detect(inputs[next++ % inputs.size()], {}).features.size();
  }
  state.counters["features"] =
      benchmark::Counter(static_cast<double>(features), benchmark::Counter::kAvgIterations);
}

void worlds(benchmark::State& state) {
  run(state, static_cast<RandomWorld::Kind>(state.range(0)), 1081, {});
}
BENCHMARK(worlds)->DenseRange(0, 2)->Unit(benchmark::kMicrosecond);

void beams(benchmark::State& state) {
  run(state, RandomWorld::Kind::kOffice, static_cast<int>(state.range(0)), {});
}
BENCHMARK(beams)->Arg(181)->Arg(361)->Arg(721)->Arg(1081)->Arg(2161)->Unit(benchmark::kMicrosecond);

void ppm(benchmark::State& state) {
  FeatureDetectorParameters parameters;
  parameters.ppm = static_cast<double>(state.range(0));
  run(state, RandomWorld::Kind::kOffice, 1081, parameters);
}
BENCHMARK(ppm)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMicrosecond);

void levels(benchmark::State& state) {
  FeatureDetectorParameters parameters;
  parameters.scale_levels = static_cast<int>(state.range(0));
  run(state, RandomWorld::Kind::kOffice, 1081, parameters);
}
BENCHMARK(levels)->DenseRange(1, 3)->Unit(benchmark::kMicrosecond);

void compareClassifiers(benchmark::State& state) {
  const FeatureDetector detector({});
  const CornerMatcher matcher;
  std::vector<std::shared_ptr<const ram_slam::FeatureMatcher::Descriptor>> descriptors;
  for (const auto& scan : scans(RandomWorld::Kind::kHall, 1081)) {
    for (const auto& feature : detector.detect(scan, {}).features) {
      descriptors.push_back(matcher.parse(feature.classifier));
    }
  }
  std::size_t next = 0;
  for (auto _ : state) {
    const auto& a = *descriptors[next % descriptors.size()];
    const auto& b = *descriptors[(next * 7 + 1) % descriptors.size()];
    benchmark::DoNotOptimize(matcher.logLikelihoodRatio(a, b));
    ++next;
  }
}
BENCHMARK(compareClassifiers);

}  // namespace

BENCHMARK_MAIN();
