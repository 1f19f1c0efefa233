// SPDX-License-Identifier: BSD-3-Clause
// Time of detection with description for one scan: tables for docs/feature_detector.md.
//
// detection_times [scans]
//
// CPU time of the thread, of each scan the best of five runs (what else the machine does comes on
// top); median and 99th percentile over scans at random places, range noise 1 cm. Bars: 0.1 ms per
// character of the median.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <time.h>

#include "ramscout_feature_detector/edge_detector.hpp"
#include "ramscout_feature_detector/feature_detector.hpp"

#include "../test/random_world.hpp"

namespace {

using namespace ramscout_feature_detector;

constexpr double kNoiseM = 0.01;
constexpr int kRuns = 5;
constexpr int kPlacesPerWorld = 20;

double threadTimeMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::vector<ram_slam::LaserScan> scansIn(RandomWorld::Kind kind, int count, int beams) {
  std::vector<ram_slam::LaserScan> scans;
  for (int i = 0; i < count; ++i) {
    const RandomWorld world(kind, 3000 + i / kPlacesPerWorld);
    ram_slam::Random random(3000, i);
    const ram_slam::Pose2 pose = world.freePose(random);
    scans.push_back(
        world.walls().scan(pose, kNoiseM, random, beams, -0.75 * M_PI, 1.5 * M_PI / (beams - 1)));
  }
  return scans;
}

template <typename Detector>
void row(const char* name,
         const Detector& detector,
         const std::vector<ram_slam::LaserScan>& scans) {
  std::vector<double> times_ms;
  std::size_t features = 0;
  for (const ram_slam::LaserScan& scan : scans) {
    double best_ms = 1e9;
    for (int run = 0; run < kRuns; ++run) {
      const double start_ms = threadTimeMs();
      const std::size_t found = detector.detect(scan, {}).features.size();
      best_ms = std::min(best_ms, threadTimeMs() - start_ms);
      if (run == 0) features += found;
    }
    times_ms.push_back(best_ms);
  }
  std::sort(times_ms.begin(), times_ms.end());
  const double median_ms = times_ms[times_ms.size() / 2];
  std::printf("| %-28s | %5.1f | %.2f | %.2f | `%s` |\n", name,
              static_cast<double>(features) / static_cast<double>(scans.size()), median_ms,
              times_ms[times_ms.size() * 99 / 100],
              std::string(static_cast<std::size_t>(10.0 * median_ms + 0.5), '#').c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 300;
  using Kind = RandomWorld::Kind;
  std::printf("| | features | median, ms | p99, ms | |\n|---|---|---|---|---|\n");
  const auto office = scansIn(Kind::kOffice, count, 1081);
  const auto polygons = scansIn(Kind::kPolygons, count, 1081);
  const auto hall = scansIn(Kind::kHall, count, 1081);
  row("office", FeatureDetector({}), office);
  row("polygons", FeatureDetector({}), polygons);
  row("hall", FeatureDetector({}), hall);
  row("office, edges", EdgeDetector({}), office);
  row("polygons, edges", EdgeDetector({}), polygons);
  row("hall, edges", EdgeDetector({}), hall);
  for (const int beams : {181, 361, 541, 721, 1081, 1441, 2161}) {
    const std::string name = "hall, " + std::to_string(beams) + " beams";
    row(name.c_str(), FeatureDetector({}), scansIn(Kind::kHall, count, beams));
  }
  for (const int ppm : {50, 75, 100, 150, 200}) {
    FeatureDetectorParameters parameters;
    parameters.ppm = ppm;
    const std::string name = "hall, " + std::to_string(ppm) + " pixels per metre";
    row(name.c_str(), FeatureDetector(parameters), hall);
  }
  for (const int levels : {1, 2, 3, 4, 5}) {
    FeatureDetectorParameters parameters;
    parameters.scale_levels = levels;
    const std::string name = "hall, " + std::to_string(levels) + " levels";
    row(name.c_str(), FeatureDetector(parameters), hall);
  }
}
