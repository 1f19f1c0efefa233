// SPDX-License-Identifier: BSD-3-Clause
// How good a map is: whether its walls are doubled, and how far it agrees with the true map.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/occupancy/map_file.hpp"
#include "ramscout_bringup/evaluation.hpp"
#include "ramscout_bringup/map_quality.hpp"

namespace {

using ramscout_bringup::DoubledWalls;
using ramscout_bringup::MapAgreement;

void addDoubledWalls(const DoubledWalls& doubled, nlohmann::ordered_json& figures) {
  figures["occupied cells"] = doubled.occupied_count;
  figures["doubled walls"] = doubled.fraction;
  figures["doubled walls across free space"] = doubled.fraction_across_free;
}

void addAgreement(const MapAgreement& agreement, nlohmann::ordered_json& figures) {
  figures["occupied IoU"] = agreement.occupied_iou;
  figures["free IoU"] = agreement.free_iou;
  figures["coverage"] = agreement.coverage;
  figures["wall distance, mean [m]"] = agreement.wall_distance_m.mean;
  figures["wall distance, RMS [m]"] = agreement.wall_distance_m.rms;
  figures["wall distance, max [m]"] = agreement.wall_distance_m.max;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Quality of a map: doubled walls, and agreement with the true map if there is one.");
  std::string map_path;
  std::string true_map_path;
  std::string trajectory_path;
  std::string truth_path;
  std::string json_path;
  app.add_option("map", map_path, "map to evaluate (yaml)")->required()->check(CLI::ExistingFile);
  CLI::Option* true_map =
      app.add_option("--true-map", true_map_path, "true map (yaml)")->check(CLI::ExistingFile);
  CLI::Option* trajectory = app.add_option("--trajectory", trajectory_path,
                                           "estimated trajectory (TUM) in the frame of the map")
                                ->check(CLI::ExistingFile);
  CLI::Option* truth =
      app.add_option("--ground-truth", truth_path,
                     "true trajectory (TUM) in the frame of the true map: aligns the maps")
          ->check(CLI::ExistingFile);
  app.add_option("--json", json_path, "also write the figures to this file");
  trajectory->needs(truth)->needs(true_map);
  truth->needs(trajectory);
  CLI11_PARSE(app, argc, argv);
  try {
    const ram_slam::OccupancyGrid map = ram_slam::loadMap(map_path);
    nlohmann::ordered_json figures;
    addDoubledWalls(ramscout_bringup::findDoubledWalls(map), figures);
    if (!true_map_path.empty()) {
      ram_slam::Pose2 true_from_estimate;
      if (!truth_path.empty()) {
        true_from_estimate =
            ramscout_bringup::compareWithTruth(ramscout_bringup::readTrajectory(trajectory_path),
                                               ramscout_bringup::readTrajectory(truth_path))
                .truth_from_map;
      }
      addAgreement(
          ramscout_bringup::compareMaps(map, ram_slam::loadMap(true_map_path), true_from_estimate),
          figures);
    }
    for (const auto& [name, value] : figures.items()) {
      std::printf("%-34s %10.4g\n", name.c_str(), value.get<double>());
    }
    if (!json_path.empty()) ram_slam::writeFileAtomically(json_path, figures.dump(2) + "\n");
  } catch (const std::exception& error) {
    std::cerr << "evaluate_map: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
