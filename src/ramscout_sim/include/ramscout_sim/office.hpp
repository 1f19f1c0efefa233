// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_parameters/parameter_table.hpp"
#include "ramscout_sim/tour.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// A generated office building: corridors around blocks of rooms, so that each block is a loop.
struct OfficeParameters {
  int seed = 1;
  int blocks_along_x = 2;
  int blocks_along_y = 1;        ///< 0: a single corridor between two rows of rooms
  double block_length_m = 17.0;  ///< along x; subdivided into rooms
  double room_depth_m = 5.0;     ///< along y; a block is two rooms deep
  double corridor_width_m = 2.0;
  double door_width_m = 1.0;
  /// Share of the rooms whose wall to the corridor is of glass.
  double glass_front_share = 0.0;
  /// Share of the rooms whose door has a leaf that can be moved; its name is door_<number>, and it
  /// is open or closed at the start.
  double movable_door_share = 0.0;
  int people = 0;  ///< who walk around the blocks

  double wall_thickness_m = 0.15;
  double wall_height_m = kWallHeight_m;
  double pane_thickness_m = 0.02;
  double shortest_room_m = 3.0;  ///< along x

  static const ram_parameters::ParameterTable<OfficeParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
  double length_m() const {
    return blocks_along_x * (block_length_m + corridor_width_m) + corridor_width_m;
  }
  /// With the outer rooms, that surround the corridors on the long sides.
  double depth_m() const {
    return blocks_along_y * (2.0 * room_depth_m + corridor_width_m) + corridor_width_m +
           2.0 * room_depth_m;
  }
};

/// Reads every key of OfficeParameters.
OfficeParameters readOfficeParameters(ram_parameters::ParameterReader& reader);

struct Office {
  World world;
  /// Around every block, through the first corridor twice.
  Tour tour;
};

/// Same parameters, same building. The corner of the building is at the origin.
Office generateOffice(const OfficeParameters& parameters);

/// Writes a tour file that readTour reads. \throws std::runtime_error if that fails
void writeTour(const Tour& tour, const std::string& path);

}  // namespace ramscout_sim
