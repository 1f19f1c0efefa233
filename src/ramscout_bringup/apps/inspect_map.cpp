// SPDX-License-Identifier: BSD-3-Clause
// States what a saved map holds, and whether it is whole.
#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/world_map/map_folder.hpp"

namespace {

struct Options {
  std::string mode;
  std::string folder = "~/.ros/maps";
  std::string name;
};

/// Whether a map has to be looked into.
bool needsMap(const Options& options) {
  if (options.mode == "new") {
    if (options.name.empty()) return false;
    throw std::invalid_argument("mode:=new begins with an empty map: leave out map:=" +
                                options.name);
  }
  if (!options.mode.empty() && options.mode != "continue" && options.mode != "localise") {
    throw std::invalid_argument("mode must be new, continue or localise, not '" + options.mode +
                                "'");
  }
  if (!options.mode.empty() && options.name.empty())
    throw std::invalid_argument("mode:=" + options.mode + " needs the name of a map: map:=NAME");
  return true;
}

void inspect(const Options& options) {
  const std::string path =
      ram_slam::pathInFolder(ram_slam::expandHome(options.folder), options.name);
  const ram_slam::WorldMap map = ram_slam::loadWorldMap(path);
  if (!options.mode.empty() && map.landmarks().landmarks.empty())
    throw std::runtime_error(path + ": it holds no landmarks: no robot is found in it");
  if (options.mode == "continue" && map.scans().empty())
    throw std::runtime_error(path + ": it holds no scans: it can be localised in, not continued");
  std::cout << path << ": " << map.landmarks().landmarks.size() << " landmarks, "
            << map.scans().size() << " scans, " << map.trajectory().size() << " poses";
  for (const auto& [frame, occupancy] : map.occupancies()) {
    std::cout << ", " << occupancy->grid.width << " x " << occupancy->grid.height << " cells of "
              << occupancy->grid.resolution_m << " m in " << frame;
  }
  std::cout << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "States what a saved map holds. Fails with one line if it is missing or damaged, or cannot "
      "serve for a start of slam.launch in the given mode.");
  app.add_option("map", options.name, "Name of the map.");
  app.add_option("--folder", options.folder, "Folder of the maps.")->capture_default_str();
  app.add_option("--mode", options.mode, "new, continue or localise: a start to be checked.");
  CLI11_PARSE(app, argc, argv);
  try {
    if (needsMap(options)) {
      inspect(options);
    } else {
      std::cout << "a new map\n";
    }
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << "inspect_map: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
