// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {

/// Settings of occupancy mapping, in process and as a node.
struct OccupancyMapperParameters {
  // What a scan contributes.
  double resolution = 0.05;   ///< edge of a cell [m]
  double max_range_m = 30.0;  ///< hits beyond it mark nothing; their beam clears up to it
  double clear_max_range_m =
      5.0;  ///< how far a beam that returned nothing (+Inf) clears; 0: not at all
  double occupied_threshold =
      0.15;            ///< a cell is occupied if more than this part of its visits were hits
  int min_visits = 1;  ///< a cell with fewer visits is unknown
  int max_cell_count = 50000000;  ///< size cap: cells in the map's bounding box

  // Which scans are mapped: those the robot moved before.
  double key_distance_m =
      0.1;  ///< a scan is mapped if the laser moved this far since the last mapped one ...
  double key_angle_rad = 0.05;  ///< ... or turned this much
  int max_scan_count =
      10000;  ///< scans kept for re-rendering; older ones stay in the map as they are

  /// A beam clears the cells that it leaves at least this far before its end: a wall at a cell's
  /// edge is not cleared by the noise of its own hits. Less than half a cell, so that rounding
  /// cannot decide at exactly half.
  double clearance_cells = 0.5 - 1e-6;
  /// A scan stays where it is drawn if its pose changes by less: less than a fraction of a cell.
  MotionGate redraw{0.002, 0.0005};

  // The node only.
  std::string map_frame = "map";
  std::string base_frame = "base_link";  ///< the frame whose trajectory is corrected
  std::string map_folder =
      "~/.ros/maps";                 ///< where save_map writes; a leading ~ is the home folder
  std::string initial_map;           ///< folder or file of a saved map to continue; empty: none
  double publish_period_s = 5.0;     ///< between whole maps
  double update_period_s = 0.5;      ///< between map updates
  double transform_timeout_s = 2.0;  ///< wall time that a scan waits for its pose
  double waiting_poll_s = 0.02;      ///< between checks whether the pose of a scan is known
  bool follow_trajectory =
      false;  ///< also re-render along every `trajectory`, not only corrected ones

  static const ram_parameters::ParameterTable<OccupancyMapperParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
OccupancyMapperParameters readOccupancyMapperParameters(ram_parameters::ParameterReader& reader);

}  // namespace ram_slam
