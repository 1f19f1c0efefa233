// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_slam/occupancy/occupancy_grid.hpp"

namespace ram_slam {

/// A map as map_server's pair of files.
struct MapFile {
  std::string pgm;   ///< P5, maxval 255, row 0 is max y: 0 occupied, 254 free, 205 unknown
  std::string yaml;  ///< image (name only), resolution, origin, negate 0, occupied_thresh 0.65,
                     ///< free_thresh 0.196
};

/// Contents of the files as map_saver writes them: cells of 65 % and more are occupied, of 0 to 25
/// % free. \param image_name  what the yaml calls the pgm \throws std::invalid_argument if the grid
/// has no cells or not width x height of them
MapFile toMapFile(const OccupancyGrid& grid, const std::string& image_name);

/// Writes `stem`.pgm and `stem`.yaml. A process that is killed meanwhile leaves the old map or the
/// new one: then the yaml may refer to `stem`.previous.pgm, which the next save removes.
/// \throws std::invalid_argument as toMapFile()
/// \throws std::system_error naming the file and the system's reason
void saveMap(const OccupancyGrid& grid, const std::string& stem);

/// Reads a map: the yaml and the P5 image it names (relative to the yaml's folder), in mode
/// trinary, scale or raw.
///
/// map_server's defaults for what the yaml lacks do not exist: image, resolution, origin, negate
/// and both thresholds are required, other keys than those and `mode` ignored. \throws
/// std::runtime_error naming file, key and line, or what is wrong with the image; a subclass with
/// the system's
///         reason if a file cannot be read. Nothing is allocated for an image of more than 100
///         million cells.
OccupancyGrid loadMap(const std::string& yaml_path);

}  // namespace ram_slam
