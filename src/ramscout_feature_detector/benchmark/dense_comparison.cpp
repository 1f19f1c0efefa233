// SPDX-License-Identifier: BSD-3-Clause
// The detector against the dense reference.
//
// dense_comparison [scans of each kind of world] [ppm] [noise, m] [recorded scans of each log]
// [LOG...]
//
// LOG: as in recorded_scans; the scans are spread evenly over it. Same: a corner of the other
// within 1 mm whose response differs by at most 5 %.
#include <cstdio>
#include <cstdlib>

#include <time.h>

#include "../test/dense_reference.hpp"
#include "../test/random_world.hpp"
#include "corrected_log.hpp"

namespace {

using namespace ramscout_feature_detector;

constexpr double kSamePlaceM = 1e-3;

double processTimeS() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class Comparison {
public:
  explicit Comparison(const FeatureDetectorParameters& parameters)
      : detector_(parameters), reference_(parameters) {}

  void add(const ram_slam::LaserScan& scan) {
    const double start_s = processTimeS();
    const auto found = detector_.analyse(scan).corners;
    const double middle_s = processTimeS();
    const auto expected = reference_.corners(scan);
    fast_s_ += middle_s - start_s;
    dense_s_ += processTimeS() - middle_s;
    ++scans_;
    fast_ += static_cast<int>(found.size());
    dense_ += static_cast<int>(expected.size());
    for (const Corner& corner : expected) compare(corner, found);
    for (const Corner& corner : found) {
      if (hasPlace(corner, expected)) continue;
      ++fast_only_;
      printOnly("fast", corner);
    }
  }

  void print(const char* name) const {
    std::printf(
        "%s: %d scans: fast %d corners, %d of them not dense; dense %d, of these %d at the same "
        "place, "
        "%d with the same response; %.2f ms and %.0f ms a scan\n",
        name, scans_, fast_, fast_only_, dense_, same_place_, same_, 1e3 * fast_s_ / scans_,
        1e3 * dense_s_ / scans_);
  }

private:
  void compare(const Corner& expected, const std::vector<Corner>& found) {
    const Eigen::Vector2d& place_m = expected.lines.position_m;
    for (const Corner& corner : found) {
      if ((corner.lines.position_m - place_m).norm() > kSamePlaceM) continue;
      ++same_place_;
      if (std::abs(corner.peak.min_eigenvalue - expected.peak.min_eigenvalue) <=
          0.05 * expected.peak.min_eigenvalue) {
        ++same_;
      } else {
        std::printf("scan %d at %.2f %.2f: response %.5f level %d, dense %.5f level %d\n", scans_,
                    place_m.x(), place_m.y(), corner.peak.min_eigenvalue, corner.peak.level,
                    expected.peak.min_eigenvalue, expected.peak.level);
      }
      return;
    }
    printOnly("dense", expected);
  }

  static bool hasPlace(const Corner& corner, const std::vector<Corner>& others) {
    return std::any_of(others.begin(), others.end(), [&](const Corner& other) {
      return (other.lines.position_m - corner.lines.position_m).norm() <= kSamePlaceM;
    });
  }

  void printOnly(const char* name, const Corner& corner) const {
    std::printf(
        "scan %d: %s only at %.2f %.2f, split %zu, level %d, response %.5f, cornerness %.3f %.3f, "
        "significance %.1f\n",
        scans_, name, corner.lines.position_m.x(), corner.lines.position_m.y(), corner.lines.split,
        corner.peak.level, corner.peak.min_eigenvalue, corner.lines.cornerness,
        corner.peak.cornerness, corner.lines.significance);
  }

  FeatureDetector detector_;
  DenseReference reference_;
  int scans_ = 0, fast_ = 0, dense_ = 0, same_place_ = 0, same_ = 0, fast_only_ = 0;
  double fast_s_ = 0.0, dense_s_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  const int simulated = argc > 1 ? std::atoi(argv[1]) : 10;
  FeatureDetectorParameters parameters;
  if (argc > 2) parameters.ppm = std::atof(argv[2]);
  const double noise_m = argc > 3 ? std::atof(argv[3]) : 0.01;
  const int recorded = argc > 4 ? std::atoi(argv[4]) : 250;
  Comparison in_worlds(parameters);
  for (int i = 0; i < 3 * simulated; ++i) {
    const RandomWorld world(static_cast<RandomWorld::Kind>(i % 3), 300 + i);
    ram_slam::Random random(300, i);
    in_worlds.add(world.walls().scan(world.freePose(random), noise_m, random));
  }
  if (simulated > 0) in_worlds.print("simulated");
  for (int file = 5; file < argc; ++file) {
    const auto log = readCorrectedLog(argv[file]);
    Comparison in_log(parameters);
    const std::size_t step = std::max<std::size_t>(1, log.size() / recorded);
    for (std::size_t i = 0; i < log.size(); i += step) in_log.add(log[i].second);
    in_log.print(argv[file]);
  }
}
