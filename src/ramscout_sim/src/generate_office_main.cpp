// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/office.hpp"

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    std::cerr
        << "usage: generate_office OUTPUT [\"{seed: 1, blocks_along_x: 2, ...}\"]\n"
           "Writes OUTPUT.yaml, an office building, and OUTPUT_tour.yaml, a way around all "
           "its blocks.\n"
           "Keys and defaults: seed 1, blocks_along_x 2, blocks_along_y 1, block_length_m "
           "17, room_depth_m 5,\n"
           "corridor_width_m 2, door_width_m 1, glass_front_share 0, movable_door_share 0, people "
           "0.\n"
           "blocks_along_y 0 makes a single corridor; 53 x 83 blocks are 1 km^2 (a world file "
           "can hold `office: {...}`\ninstead).\n";
    return EXIT_FAILURE;
  }
  try {
    ram_parameters::ParameterReader reader(argc > 2 ? YAML::Load(argv[2]) : YAML::Node(),
                                           "generate_office");
    const ramscout_sim::Office office =
        ramscout_sim::generateOffice(ramscout_sim::readOfficeParameters(reader));
    const std::string output = argv[1];
    ramscout_sim::writeWorldFile(office.world, output + ".yaml");
    ramscout_sim::writeTour(office.tour, output + "_tour.yaml");
  } catch (const std::exception& error) {
    std::cerr << "generate_office: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
