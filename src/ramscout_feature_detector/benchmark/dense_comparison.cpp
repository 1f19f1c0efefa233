// SPDX-License-Identifier: BSD-3-Clause
// The detector against the dense reference: dense_comparison [scans of each kind of world] [ppm]
// [noise, m]
//
// Same: a corner of the other within 1 mm whose response differs by at most 5 %.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "../test/dense_reference.hpp"
#include "../test/random_world.hpp"

int main(int argc, char** argv) {
  using namespace ramscout_feature_detector;
  const int scans = argc > 1 ? std::atoi(argv[1]) : 10;
  FeatureDetectorParameters parameters;
  if (argc > 2) parameters.ppm = std::atof(argv[2]);
  const double noise_m = argc > 3 ? std::atof(argv[3]) : 0.01;
  const FeatureDetector detector(parameters);
  const DenseReference reference(parameters);
  int fast = 0, dense = 0, same_place = 0, same = 0;
  double fast_s = 0.0, dense_s = 0.0;
  const auto now = [] { return std::chrono::steady_clock::now(); };
  for (int i = 0; i < 3 * scans; ++i) {
    const RandomWorld world(static_cast<RandomWorld::Kind>(i % 3), 300 + i);
    ram_slam::Random random(300, i);
    const auto scan = world.walls().scan(world.freePose(random), noise_m, random);
    const auto start = now();
    const auto found = detector.analyse(scan).corners;
    const auto middle = now();
    const auto expected = reference.corners(scan);
    const auto end = now();
    fast_s += std::chrono::duration<double>(middle - start).count();
    dense_s += std::chrono::duration<double>(end - middle).count();
    fast += static_cast<int>(found.size());
    dense += static_cast<int>(expected.size());
    for (const Corner& corner : expected) {
      bool here = false;
      for (const Corner& other : found) {
        if ((other.lines.position_m - corner.lines.position_m).norm() > 1e-3) continue;
        here = true;
        ++same_place;
        const bool equal = std::abs(other.response - corner.response) <= 0.05 * corner.response;
        same += equal ? 1 : 0;
        if (!equal) {
          std::printf("scan %d at %.2f %.2f: response %.5f level %d, dense %.5f level %d\n", i,
                      corner.lines.position_m.x(), corner.lines.position_m.y(), other.response,
                      other.level, corner.response, corner.level);
        }
      }
      if (!here) {
        std::printf("scan %d: dense only at %.2f %.2f, cornerness %.3f, significance %.1f\n", i,
                    corner.lines.position_m.x(), corner.lines.position_m.y(), corner.cornerness,
                    corner.lines.significance);
      }
    }
  }
  std::printf(
      "%d scans: fast %d corners, dense %d, of these %d at the same place, %d with the same "
      "response; "
      "%.2f ms and %.0f ms a scan\n",
      3 * scans, fast, dense, same_place, same, 1e3 * fast_s / (3 * scans),
      1e3 * dense_s / (3 * scans));
}
