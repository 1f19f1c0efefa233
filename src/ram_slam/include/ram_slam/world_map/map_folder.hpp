// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam {

/// The file of a saved map's folder that holds all of it.
inline const std::string kWorldFileName = "map.world";

/// Saves a map as a folder, in one step (writeFolderAtomically()): `map.world` (toBytes()), and
/// `map.pgm` and `map.yaml` (toMapFile()) if there is a grid of the whole map. The same map gives
/// the same bytes.
/// \param map_frame  frame of the grid of the whole map
/// \throws std::system_error naming the file or folder and the system's reason
void saveMapFolder(const WorldMap& map, const std::string& map_frame, const std::string& path);

/// The map in a file, or in a folder that saveMapFolder() wrote.
/// \throws std::runtime_error naming the file, with the system's reason or what is wrong with it
WorldMap loadWorldMap(const std::string& path);

}  // namespace ram_slam
