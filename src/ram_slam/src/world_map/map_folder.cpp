// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/world_map/map_folder.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/io/atomic_folder.hpp"
#include "ram_slam/occupancy/map_file.hpp"
#include "ram_slam/world_map/world_map_file.hpp"

namespace ram_slam {

void saveMapFolder(const WorldMap& map, const std::string& map_frame, const std::string& path) {
  std::map<std::string, std::string> files{{kWorldFileName, toBytes(map)}};
  const auto whole = map.occupancies().find(map_frame);
  if (whole != map.occupancies().end() && !whole->second->grid.cells.empty()) {
    const MapFile image = toMapFile(whole->second->grid, "map.pgm");
    files["map.pgm"] = image.pgm;
    files["map.yaml"] = image.yaml;
  }
  writeFolderAtomically(path, files);
}

WorldMap loadWorldMap(const std::string& path) {
  std::error_code none;
  const bool is_folder = std::filesystem::is_directory(path, none);
  const std::string file = is_folder ? path + "/" + kWorldFileName : path;
  const std::string bytes = readWholeFile(file);  // names the file itself
  try {
    return worldMapFromBytes(bytes);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace ram_slam
