// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "ramscout_sim/world_corners.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "Writes the corners that a perfect lidar at that height could see: place, orientation, "
      "opening angle, lengths of both walls.");
  std::string world;
  std::string output;
  ramscout_sim::CornerParameters parameters;
  app.add_option("WORLD", world, "any file that the simulator takes")->required();
  app.add_option("OUTPUT", output, "a YAML file")->required();
  app.add_option("HEIGHT_M", parameters.height_m, "of the lidar above the floor")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    const auto corners = ramscout_sim::cornersOf(ramscout_sim::readWorld(world), parameters);
    if (corners.empty()) {
      throw std::runtime_error(
          world + " has no corner at a height of " + std::to_string(parameters.height_m) +
          " m; corners are found for boxes and cylinders, not for the cells of "
          "a map or the triangles of a mesh");
    }
    ramscout_sim::writeCorners(corners, output);
  } catch (const std::exception& error) {
    std::cerr << "export_world_corners: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
