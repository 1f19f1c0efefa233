// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/office.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "Writes OUTPUT.yaml, an office building, and OUTPUT_tour.yaml, a way around all its blocks.");
  std::string output;
  std::string parameters;
  app.add_option("OUTPUT", output, "path without ending")->required();
  app.add_option("PARAMETERS", parameters,
                 "{seed: 1, blocks_along_x: 2, ...}; keys and defaults: seed 1, blocks_along_x 2, "
                 "blocks_along_y 1, block_length_m 17, room_depth_m 5, corridor_width_m 2, "
                 "door_width_m 1, glass_front_share 0, movable_door_share 0, people 0. "
                 "blocks_along_y 0 makes a single corridor; 53 x 83 blocks are 1 km^2 (a world "
                 "file can hold `office: {...}` instead).");
  CLI11_PARSE(app, argc, argv);
  try {
    ram_parameters::ParameterReader reader(YAML::Load(parameters), "generate_office");
    const ramscout_sim::Office office =
        ramscout_sim::generateOffice(ramscout_sim::readOfficeParameters(reader));
    ramscout_sim::writeWorldFile(office.world, output + ".yaml");
    ramscout_sim::writeTour(office.tour, output + "_tour.yaml");
  } catch (const std::exception& error) {
    std::cerr << "generate_office: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
