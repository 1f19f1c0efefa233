// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "ramscout_sim/world_corners.hpp"

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::cerr
        << "usage: export_world_corners WORLD OUTPUT.yaml [HEIGHT_M]\n"
           "Writes the corners that a perfect lidar at that height (0.37 m) could see: place, "
           "orientation,\nopening angle, lengths of both walls.\n";
    return EXIT_FAILURE;
  }
  try {
    ramscout_sim::CornerParameters parameters;
    if (argc > 3) parameters.height_m = std::stod(argv[3]);
    ramscout_sim::writeCorners(
        ramscout_sim::cornersOf(ramscout_sim::readWorld(argv[1]), parameters), argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "export_world_corners: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
