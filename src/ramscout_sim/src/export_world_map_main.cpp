// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "ramscout_sim/map_image.hpp"

int main(int argc, char** argv) {
  if (argc < 3 || argc > 5) {
    std::cerr << "usage: export_world_map WORLD.yaml OUTPUT [RESOLUTION_M [HEIGHT_M]]\n"
                 "Writes OUTPUT.pgm and OUTPUT.yaml: the map that a perfect lidar at that height "
                 "would draw\n"
                 "(resolution 0.05 m, height 0.37 m).\n";
    return EXIT_FAILURE;
  }
  try {
    const double resolution_m = argc > 3 ? std::stod(argv[3]) : 0.05;
    const double height_m = argc > 4 ? std::stod(argv[4]) : 0.37;
    ramscout_sim::writeMap(
        ramscout_sim::drawMap(ramscout_sim::readWorld(argv[1]), height_m, resolution_m), argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "export_world_map: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
