// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/occupancy/occupancy_mapper_parameters.hpp"

namespace ram_slam {

using namespace ram_parameters;

namespace {

bool isFrame(const std::string& name) {
  return !name.empty() && name.front() != '/';
}

using P = OccupancyMapperParameters;

/// What one scan contributes, and which scans are mapped.
void addMapRows(ParameterTable<P>& table) {
  table.heading("What a scan contributes")
      .add("resolution", &P::resolution, "m", within(0.001, 10.0), "Edge of a cell.")
      .add("max_range_m", &P::max_range_m, "m", within(0.001, 1000.0),
           "Hits beyond it mark nothing, their beams clear up to it.")
      .rule(&P::max_range_m, ">= resolution",
            [](const P& p) { return p.max_range_m >= p.resolution; })
      .add("clear_max_range_m", &P::clear_max_range_m, "m", atLeast(0.0),
           "How far a beam that returned nothing (+Inf) clears; 0: not at all.")
      .rule(&P::clear_max_range_m, "<= max_range_m",
            [](const P& p) { return p.clear_max_range_m <= p.max_range_m; })
      .add("occupied_threshold", &P::occupied_threshold, "", within(0.0, 0.99),
           "A cell is occupied if more than this part of its visits were hits.")
      .add("min_visits", &P::min_visits, "", within(1, 1000000),
           "A cell that fewer scans saw is unknown.")
      .add("max_cell_count", &P::max_cell_count, "", within(4096, 1000000000),
           "Size limit: cells in the map's bounding box.")
      .heading(
          "Which scans are mapped; they are kept to draw the map again along a corrected "
          "trajectory")
      .add("key_distance_m", &P::key_distance_m, "m", within(0.0, 10.0),
           "Mapped if the laser moved this far since the last mapped scan; 0: every scan.")
      .add("key_angle_rad", &P::key_angle_rad, "rad", within(0.0, 3.15),
           "Mapped if the laser turned by this much since then; 0: every scan.")
      .add("max_scan_count", &P::max_scan_count, "", within(1, 10000000),
           "Scans kept; older ones stay in the map as they are.")
      .expert("Drawing: details")
      .add("clearance_cells", &P::clearance_cells, "cells", atLeast(0.0),
           "A beam clears the cells that it leaves at least this far before its end: the noise of "
           "hits does not clear a wall at a cell's edge.")
      .include(&P::redraw,
               motionGateTable("A scan stays where it is drawn if its pose changes by less: less "
                               "than a fraction of a cell."),
               "redraw_");
}

void addNodeRows(ParameterTable<P>& table) {
  table.heading("Node")
      .add("map_frame", &P::map_frame, "tf frame of the map.")
      .rule(&P::map_frame, "a frame's name without leading slash",
            [](const P& p) { return isFrame(p.map_frame); })
      .add("base_frame", &P::base_frame,
           "tf frame whose trajectory is corrected: the robot's base.")
      .rule(&P::base_frame, "a frame's name without leading slash",
            [](const P& p) { return isFrame(p.base_frame); })
      .add("map_folder", &P::map_folder,
           "Where the service save_map writes; a leading ~ is the home folder.")
      .rule(&P::map_folder, "not empty", [](const P& p) { return !p.map_folder.empty(); })
      .add("initial_map", &P::initial_map,
           "Saved map (folder, or a file in it, of the service save_map of world_map) to continue, "
           "once the robot is found in it; empty: an empty map. (docs/maps.md)")
      .add("publish_period_s", &P::publish_period_s, "s", within(0.1, 3600.0),
           "Between publications of the whole map.")
      .add("update_period_s", &P::update_period_s, "s", within(0.05, 3600.0),
           "Between publications of what changed.")
      .add("transform_timeout_s", &P::transform_timeout_s, "s", within(0.0, 60.0),
           "How long a scan waits for its pose, wall time.")
      .add("follow_trajectory", &P::follow_trajectory,
           "Draw the map again along every `trajectory` of the estimator, not only corrected ones.")
      .expert("Node: details")
      .add("waiting_poll_s", &P::waiting_poll_s, "s", within(0.001, 10.0),
           "How often is checked whether the pose of a waiting scan is known, wall time.");
}

}  // namespace

const ParameterTable<OccupancyMapperParameters>& OccupancyMapperParameters::table() {
  static const auto table = [] {
    ParameterTable<P> rows;
    addMapRows(rows);
    addNodeRows(rows);
    return rows;
  }();
  return table;
}

void OccupancyMapperParameters::validate() const {
  table().check(*this);
}

OccupancyMapperParameters readOccupancyMapperParameters(ParameterReader& reader) {
  return OccupancyMapperParameters::table().readAll(reader);
}

}  // namespace ram_slam
