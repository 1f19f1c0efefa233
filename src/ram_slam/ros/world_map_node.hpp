// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include <nav_msgs/GetMap.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/ColoredCloud.h>
#include <ram_slam_msgs/GetRegion.h>
#include <ram_slam_msgs/LandmarkMap.h>
#include <ram_slam_msgs/LoadMap.h>
#include <ram_slam_msgs/LocalOccupancy.h>
#include <ram_slam_msgs/SaveMap.h>
#include <ros/ros.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/world_map/world_map.hpp"

namespace ram_slam_ros {

struct WorldMapNodeParameters {
  /// Frame of everything that is stored; what comes in another one is refused.
  std::string map_frame = "map";
  /// Where maps are saved and loaded; a leading ~ is the home folder.
  std::string map_folder = "~/.ros/maps";
  /// Folder or file of a saved map to begin with; empty: none.
  std::string initial_map;
  /// Whether the map stays as it is: nothing is taken in, and it is published.
  bool read_only = false;

  /// \throws std::invalid_argument naming the parameter that is empty
  void validate() const;
};

/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of range
WorldMapNodeParameters readWorldMapNodeParameters(ram_parameters::ParameterReader& reader);

/// Keeps `map`, `local_occupancy`, `landmarks`, `colored_cloud` and `trajectory` as they come;
/// answers `static_map`, ~get_region, ~save_map and ~load_map. Messages are handled while files are
/// written and read. With read_only nothing is taken in; `map` and `map_metadata` are published.
class WorldMapNode {
public:
  /// \throws std::invalid_argument if a parameter is refused
  explicit WorldMapNode(ram_parameters::ParameterReader& reader);

private:
  /// Takes one part, already converted; logs why if it is refused.
  template <typename Message, typename Convert>
  void store(const Message& message, const Convert& convert);
  bool onGetRegion(ram_slam_msgs::GetRegion::Request& request,
                   ram_slam_msgs::GetRegion::Response& response);
  bool onSaveMap(ram_slam_msgs::SaveMap::Request& request,
                 ram_slam_msgs::SaveMap::Response& response);
  bool onLoadMap(ram_slam_msgs::LoadMap::Request& request,
                 ram_slam_msgs::LoadMap::Response& response);
  bool onStaticMap(nav_msgs::GetMap::Request& request, nav_msgs::GetMap::Response& response);
  void subscribe();
  /// Where a map of that name is saved.
  std::string pathOf(const std::string& name) const;
  /// Puts the grid of now and its scans into a map. \return what is missing in it, to be logged
  std::string addDrawnMap(ram_slam::WorldMap& map);
  /// The grid of the whole map; no cells if there is none.
  nav_msgs::OccupancyGrid wholeGrid();
  /// Publishes the map that was loaded.
  void publishMap();
  ram_slam::WorldMap snapshot();
  NodeDiagnostics::Report report();

  WorldMapNodeParameters parameters_;
  std::mutex map_mutex_;
  ram_slam::WorldMap map_;
  std::mutex file_mutex_;  ///< one file at a time

  ros::NodeHandle node_;
  std::vector<ros::ServiceServer> services_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Publisher map_publisher_;
  ros::Publisher metadata_publisher_;
  NodeDiagnostics diagnostics_;
};

}  // namespace ram_slam_ros
