// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/parameter_files.hpp"

#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"
#include "ram_slam/scan_matching/laser_odometry_parameters.hpp"
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"
#include "ram_slam/smoothing/map_smoother.hpp"
#include "ram_slam/stages/fast_slam_node_parameters.hpp"
#include "ram_slam/tracking/recovery_parameters.hpp"

namespace ram_slam {
namespace {

std::vector<ram_parameters::ParameterRow> fastSlamRows() {
  std::vector<ram_parameters::ParameterRow> rows = FastSlamParameters::table().rows();
  ram_parameters::append(rows, RecoveryParameters::table().rows(), "relocalisation");
  ram_parameters::append(rows, FastSlamNodeParameters::table().rows(), "node");
  return rows;
}

}  // namespace

std::vector<ram_parameters::ParameterFile> parameterFiles() {
  return {
      {"fast_slam.yaml", "ram_slam/fast_slam",
       "Motion and features in, pose and landmarks out (docs/fast_slam.md).", fastSlamRows()},
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
}

}  // namespace ram_slam
