// SPDX-License-Identifier: BSD-3-Clause
// What the simulator reads, and the nodes' parameters.
#include <algorithm>
#include <fstream>

#include <ram_slam/estimation/estimator_registry.hpp>
#include <ram_slam/io/atomic_file.hpp>
#include <ram_slam/parameter_files.hpp>
#include <ramscout_bringup/named_file.hpp>
#include <ramscout_bringup/slam_pipeline.hpp>
#include <ramscout_sim/faults.hpp>
#include <ramscout_sim/robot_description.hpp>
#include <ramscout_sim/tour.hpp>
#include <ramscout_sim/world.hpp>

#include "fuzz_target.hpp"

namespace ramscout_bringup_ros {
namespace {

void readWorld(const std::string& path) {
  ramscout_sim::readWorld(path);
}

/// A world, by a reader that goes by the file's suffix.
FuzzTarget worldTarget(const std::string& name) {
  return fileTarget(name, storedSeeds(name), readWorld);
}

std::string robotSeed() {
  return ram_slam::readWholeFile(CONFIG_FOLDER "/robots/car.urdf");
}

std::string parameterSeed() {
  const auto files = ram_slam::parameterFiles();
  const auto file = std::find_if(files.begin(), files.end(),
                                 [](const auto& any) { return any.name == "fast_slam.yaml"; });
  return toYaml(*file);
}

void readFastSlam(const std::string& path) {
  ramscout_bringup::namingFile(path, [&] {
    ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
    return ram_slam::findEstimator("fast_slam")(reader, ramscout_bringup::featureMatchers());
  });
}

}  // namespace

std::vector<FuzzTarget> worldTargets() {
  const auto read_robot = [](const std::string& path) { ramscout_sim::readRobot(path); };
  const auto read_faults = [](const std::string& path) { ramscout_sim::readFaults(path); };
  const auto read_tour = [](const std::string& path) { ramscout_sim::readTour(path); };
  return {
      fileTarget("fast_slam.yaml", {parameterSeed()}, readFastSlam),
      worldTarget("world.yaml"),
      worldTarget("world.sdf"),
      fileTarget("world.urdf", {robotSeed()}, readWorld),
      worldTarget("mesh.stl"),
      worldTarget("mesh.obj"),
      worldTarget("mesh.dae"),
      fileTarget("robot.urdf", {robotSeed()}, read_robot),
      fileTarget("faults.yaml", storedSeeds("faults.yaml"), read_faults),
      fileTarget("tour.yaml", storedSeeds("tour.yaml"), read_tour),
  };
}

}  // namespace ramscout_bringup_ros
