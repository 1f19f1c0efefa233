// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/parameter_files.hpp"

#include "ram_slam/estimation/estimator_registry.hpp"
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"
#include "ram_slam/scan_matching/laser_odometry_parameters.hpp"
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"
#include "ram_slam/stages/fast_slam_node_parameters.hpp"
#include "ram_slam/tracking/recovery_parameters.hpp"

namespace ram_slam {
namespace {

/// One file per estimator: the same node, with other parameters.
std::vector<ram_parameters::ParameterFile> estimatorFiles() {
  std::vector<ram_parameters::ParameterFile> files;
  for (const auto& [name, filter] : filters()) {
    std::vector<ram_parameters::ParameterRow> rows = filter.rows;
    ram_parameters::append(rows, RecoveryParameters::table().rows(), "relocalisation");
    FastSlamNodeParameters node;
    node.estimator = name;
    ram_parameters::append(rows, FastSlamNodeParameters::table().rows(node), "node");
    files.push_back({name + ".yaml", "ram_slam/fast_slam", filter.purpose, rows});
  }
  return files;
}

}  // namespace

std::vector<ram_parameters::ParameterFile> parameterFiles() {
  std::vector<ram_parameters::ParameterFile> files = estimatorFiles();
  const std::vector<ram_parameters::ParameterFile> others = {
      {"landmark_smoother.yaml", "ram_slam/landmark_smoother",
       "All features of a run and the estimator's result in, landmarks and a trajectory that agree "
       "with all of them out.",
       LandmarkSmootherParameters::table().rows()},
      {"laser_odometry.yaml", "ram_slam/laser_odometry",
       "Refines wheel odometry by scans, or replaces it.", LaserOdometryParameters::table().rows()},
      {"map_smoother.yaml", "ram_slam/map_smoother",
       "A trajectory and the scans taken along it in, a trajectory that agrees with all of them "
       "out.",
       MapSmootherParameters::table().rows()},
      {"occupancy_mapper.yaml", "ram_slam/occupancy_mapper",
       "Draws the occupancy map: which cells the scans saw free, and in which they hit "
       "something.",
       OccupancyMapperParameters::table().rows()}};
  files.insert(files.end(), others.begin(), others.end());
  return files;
}

}  // namespace ram_slam
