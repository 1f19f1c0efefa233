// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "ramscout_sim/map_image.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "Writes OUTPUT.pgm and OUTPUT.yaml: the map that a perfect lidar at that height would draw.");
  std::string world;
  std::string output;
  double resolution_m = 0.05;
  double height_m = 0.37;
  app.add_option("WORLD", world, "any file that the simulator takes")->required();
  app.add_option("OUTPUT", output, "path without ending")->required();
  app.add_option("RESOLUTION_M", resolution_m, "of a cell")->capture_default_str();
  app.add_option("HEIGHT_M", height_m, "of the lidar above the floor")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    ramscout_sim::writeMap(
        ramscout_sim::drawMap(ramscout_sim::readWorld(world), height_m, resolution_m), output);
  } catch (const std::exception& error) {
    std::cerr << "export_world_map: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
