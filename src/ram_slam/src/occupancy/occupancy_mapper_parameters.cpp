// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"

#include <sstream>
#include <stdexcept>

namespace ram_slam {
namespace {

/// Throws unless low <= value <= high; false for NaN.
void require(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  std::ostringstream message;
  message << name << " must be in [" << low << ", " << high << "], got " << value;
  throw std::invalid_argument(message.str());
}

void requireFrame(const char* name, const std::string& frame) {
  if (!frame.empty() && frame.front() != '/') return;
  throw std::invalid_argument(std::string(name) +
                              " must be a frame's name without leading slash, got '" + frame + "'");
}

}  // namespace

void OccupancyMapperParameters::validate() const {
  require("resolution", resolution, 0.001, 10.0);
  require("max_range_m", max_range_m, resolution, 1000.0);
  require("clear_max_range_m", clear_max_range_m, 0.0, max_range_m);
  require("occupied_threshold", occupied_threshold, 0.0, 0.99);
  require("min_visits", min_visits, 1, 1000000);
  require("max_cell_count", max_cell_count, 4096, 1000000000);
  require("key_distance_m", key_distance_m, 0.0, 10.0);
  require("key_angle_rad", key_angle_rad, 0.0, 3.15);
  require("max_scan_count", max_scan_count, 1, 10000000);
  require("publish_period_s", publish_period_s, 0.1, 3600.0);
  require("update_period_s", update_period_s, 0.05, 3600.0);
  require("transform_timeout_s", transform_timeout_s, 0.0, 60.0);
  requireFrame("map_frame", map_frame);
  requireFrame("base_frame", base_frame);
  if (map_folder.empty()) throw std::invalid_argument("map_folder must not be empty");
}

OccupancyMapperParameters readOccupancyMapperParameters(ram_parameters::ParameterReader& reader) {
  OccupancyMapperParameters parameters;
  reader.read("resolution", parameters.resolution);
  reader.read("max_range_m", parameters.max_range_m);
  reader.read("clear_max_range_m", parameters.clear_max_range_m);
  reader.read("occupied_threshold", parameters.occupied_threshold);
  reader.read("min_visits", parameters.min_visits);
  reader.read("max_cell_count", parameters.max_cell_count);
  reader.read("key_distance_m", parameters.key_distance_m);
  reader.read("key_angle_rad", parameters.key_angle_rad);
  reader.read("max_scan_count", parameters.max_scan_count);
  reader.read("map_frame", parameters.map_frame);
  reader.read("base_frame", parameters.base_frame);
  reader.read("map_folder", parameters.map_folder);
  reader.read("publish_period_s", parameters.publish_period_s);
  reader.read("update_period_s", parameters.update_period_s);
  reader.read("transform_timeout_s", parameters.transform_timeout_s);
  reader.read("follow_trajectory", parameters.follow_trajectory);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

}  // namespace ram_slam
