// SPDX-License-Identifier: BSD-3-Clause
// Carries a simulated robot away to random places of a building it has mapped, and reports how it
// is relocalised: kidnapping CONFIG_FOLDER SEED COUNT
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "kidnapping.hpp"

namespace {

constexpr double kMost_m = 30.0;
constexpr double kBarDistance_m = 15.0;
constexpr double kBarLost_s = 2.0;
constexpr double kBarWrong_s = 5.0;

int run(const char* config, int seed, int count) {
  ramscout_bringup::KidnappedRobot robot(config, seed);
  const double lost_s = robot.map();
  std::printf(
      "mapped: %zu landmarks, trajectory off by %.3f m, at the end %.3f m, taken for lost %.1f s\n",
      robot.landmarkCount(), robot.mappingError_m(), robot.error_m(), lost_s);
  std::printf("%8s %8s %8s %9s %9s %8s %8s %s\n", "x [m]", "y [m]", "yaw", "lost [s]", "found [m]",
              "off [m]", "wrong[s]", "map untouched");
  int noticed = 0;
  int recovered = 0;
  int held_wrong = 0;
  int untouched = 0;
  for (int i = 0; i < count; ++i) {
    const auto result = robot.kidnap(kMost_m);
    std::printf("%8.2f %8.2f %8.2f %9.2f %9.2f %8.3f %8.2f %s\n", result.truth.x_m,
                result.truth.y_m, result.truth.yaw_rad, result.lost_after_s,
                result.recovered_after_m, result.error_m, result.longest_wrong_s,
                result.map_untouched ? "yes" : "NO");
    std::fflush(stdout);
    noticed += result.lost_after_s >= 0.0 && result.lost_after_s <= kBarLost_s ? 1 : 0;
    recovered +=
        result.recovered_after_m >= 0.0 && result.recovered_after_m <= kBarDistance_m ? 1 : 0;
    held_wrong += result.longest_wrong_s > kBarWrong_s ? 1 : 0;
    untouched += result.map_untouched ? 1 : 0;
  }
  std::printf(
      "of %d: lost within %.0f s %d, recovered within %.0f m %d, wrong for more than %.0f s "
      "%d, map untouched %d\n",
      count, kBarLost_s, noticed, kBarDistance_m, recovered, kBarWrong_s, held_wrong, untouched);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: kidnapping CONFIG_FOLDER SEED COUNT\n";
    return EXIT_FAILURE;
  }
  try {
    return run(argv[1], std::atoi(argv[2]), std::atoi(argv[3]));
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
