// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include <benchmark/benchmark.h>

#include "ram_slam/ekf_slam/ekf_slam.hpp"
#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/tracking/tracker.hpp"

namespace ram_slam {
namespace {

/// Drives 5 mm between readings, so that the map learns in one reading of twenty, or 0.1 m, so that
/// it always does.
class Crawl : public MotionModel {
public:
  explicit Crawl(double step_m) : step_m_(step_m) {}
  PoseWithCovariance2 motion(std::int64_t from_ns, std::int64_t to_ns) const override {
    PoseWithCovariance2 motion;
    motion.pose.x_m = step_m_ * static_cast<double>(to_ns - from_ns);
    motion.covariance.diagonal() << 1e-5, 1e-5, 1e-6;
    return motion;
  }
  std::vector<Pose2> sample(const std::vector<Pose2>& map_from_base,
                            std::int64_t /*from_ns*/,
                            std::int64_t /*to_ns*/,
                            std::uint64_t /*seed*/) const override {
    return map_from_base;
  }

private:
  double step_m_;
};

/// A street of poles in two rows, 1 m apart; the 20 nearest ones ahead are seen.
FeatureList seenFrom(double x_m, std::int64_t stamp_ns, Random& random) {
  constexpr double kSigma_m = 0.02;
  FeatureList list;
  list.stamp_ns = stamp_ns;
  for (int i = 0; i < 20; ++i) {
    Feature feature;
    feature.type = "pole";
    feature.position_m = {std::floor(x_m) + 1.0 + i / 2 - x_m, i % 2 == 0 ? 2.0 : -2.0};
    feature.position_m += kSigma_m * Eigen::Vector2d(random.gaussian(), random.gaussian());
    feature.covariance_m2 = kSigma_m * kSigma_m * Eigen::Matrix2d::Identity();
    list.features.push_back(feature);
  }
  return list;
}

/// One update of 100 particles by 20 features with about 1,000 landmarks in the map. The argument
/// is the distance between readings [mm].
void update(benchmark::State& state) {
  const Crawl fast(0.1);
  FastSlam filter{FastSlamParameters{}};
  Random random(1);
  std::int64_t stamp_ns = 1;
  double x_m = 0.0;
  for (; filter.best().landmarks.size() < 1000; ++stamp_ns, x_m += 0.1) {
    filter.update(seenFrom(x_m, stamp_ns, random), fast);
  }
  const double step_m = 1e-3 * static_cast<double>(state.range(0));
  const Crawl crawl(step_m);
  for (auto _ : state) {
    state.PauseTiming();
    x_m += step_m;
    const FeatureList list = seenFrom(x_m, stamp_ns++, random);
    state.ResumeTiming();
    filter.update(list, crawl);
  }
  state.counters["landmarks"] = static_cast<double>(filter.best().landmarks.size());
  state.counters["kB"] = static_cast<double>(filter.landmarkBytes()) / 1024.0;
}
BENCHMARK(update)->Arg(5)->Arg(100)->Unit(benchmark::kMicrosecond)->Iterations(200);

/// The same of EKF-SLAM.
void updateJointly(benchmark::State& state) {
  const Crawl fast(0.1);
  EkfSlam filter{EkfSlamParameters{}};
  const auto update = [&filter](const FeatureList& list, const MotionModel& model) {
    filter.update(list, motionStep(model, filter.stamp_ns(), list.stamp_ns));
  };
  Random random(1);
  std::int64_t stamp_ns = 1;
  double x_m = 0.0;
  for (; filter.belief().size() < 1000; ++stamp_ns, x_m += 0.1)
    update(seenFrom(x_m, stamp_ns, random), fast);
  const double step_m = 1e-3 * static_cast<double>(state.range(0));
  const Crawl crawl(step_m);
  for (auto _ : state) {
    state.PauseTiming();
    x_m += step_m;
    const FeatureList list = seenFrom(x_m, stamp_ns++, random);
    state.ResumeTiming();
    update(list, crawl);
  }
  state.counters["landmarks"] = static_cast<double>(filter.belief().size());
}
BENCHMARK(updateJointly)->Arg(5)->Arg(100)->Unit(benchmark::kMicrosecond)->Iterations(200);

/// What the filter's thread does for a checkpoint of 1,000 landmarks and the path to them; with
/// argument 1 what the writing thread does, but for the disk.
void checkpoint(benchmark::State& state) {
  const Crawl fast(0.1);
  Tracker slam{fastSlamFactory(FastSlamParameters{}), RecoveryParameters{}};
  Random random(1);
  std::int64_t stamp_ns = 1;
  for (double x_m = 0.0; slam.filter().best().landmarks.size() < 1000; ++stamp_ns, x_m += 0.1)
    slam.update(seenFrom(x_m, stamp_ns, random), fast);
  const Checkpoint kept = slam.checkpoint();
  for (auto _ : state) {
    if (state.range(0) == 0) {
      benchmark::DoNotOptimize(slam.checkpoint());
    } else {
      benchmark::DoNotOptimize(toBytes(kept));
    }
  }
  state.counters["kB"] = static_cast<double>(toBytes(kept).size()) / 1024.0;
}
BENCHMARK(checkpoint)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ram_slam
