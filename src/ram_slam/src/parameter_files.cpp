// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/parameter_files.hpp"

#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"
#include "ram_slam/scan_matching/laser_odometry_parameters.hpp"

namespace ram_slam {

std::vector<ram_parameters::ParameterFile> parameterFiles() {
  return {
      {"laser_odometry.yaml", "ram_slam/laser_odometry",
       "Refines wheel odometry by scans, or replaces it.", LaserOdometryParameters::table().rows()},
      {"occupancy_mapper.yaml", "ram_slam/occupancy_mapper",
       "Draws the occupancy map: which cells the scans saw free, and in which they hit "
       "something.",
       OccupancyMapperParameters::table().rows()}};
}

}  // namespace ram_slam
