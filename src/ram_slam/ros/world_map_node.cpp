// SPDX-License-Identifier: BSD-3-Clause
#include "world_map_node.hpp"

#include <exception>
#include <filesystem>
#include <stdexcept>

#include <ram_slam_msgs/GetDrawnMap.h>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"
#include "ram_slam/world_map/map_folder.hpp"

#include "node_defaults.hpp"
#include "world_map_conversions.hpp"

namespace ram_slam_ros {
namespace {

/// Of maps of earlier versions, which were single files.
constexpr const char* kOldExtension = ".world";
constexpr const char* kDrawnMapService = "occupancy_mapper/get_drawn_map";

/// A grid in the map frame itself is a local one whose frame is the map.
ram_slam::LocalOccupancy toOccupancyOfWholeMap(const nav_msgs::OccupancyGrid& message) {
  ram_slam::LocalOccupancy occupancy;
  occupancy.stamp_ns = toNanoseconds(message.header.stamp);
  occupancy.frame = message.header.frame_id;
  occupancy.grid = toOccupancyGrid(message);
  return occupancy;
}

}  // namespace

void WorldMapNodeParameters::validate() const {
  if (map_frame.empty()) throw std::invalid_argument("map_frame must not be empty");
  if (map_folder.empty()) throw std::invalid_argument("map_folder must not be empty");
  if (read_only && initial_map.empty())
    throw std::invalid_argument("read_only must be false without initial_map");
}

WorldMapNodeParameters readWorldMapNodeParameters(ram_parameters::ParameterReader& reader) {
  WorldMapNodeParameters parameters;
  reader.read("map_frame", parameters.map_frame);
  reader.read("map_folder", parameters.map_folder);
  reader.read("initial_map", parameters.initial_map);
  reader.read("read_only", parameters.read_only);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

WorldMapNode::WorldMapNode(ram_parameters::ParameterReader& reader)
    : parameters_(readWorldMapNodeParameters(reader)),
      diagnostics_(ram_slam::Link::kMap, "store", [this] { return report(); }) {
  if (!parameters_.initial_map.empty())
    map_ = ram_slam::loadWorldMap(ram_slam::expandHome(parameters_.initial_map));
  if (parameters_.read_only) {
    map_publisher_ = node_.advertise<nav_msgs::OccupancyGrid>("map", 1, kLatched);
    metadata_publisher_ = node_.advertise<nav_msgs::MapMetaData>("map_metadata", 1, kLatched);
    publishMap();
  } else {
    subscribe();
  }
  ros::NodeHandle private_node("~");
  services_ = {node_.advertiseService("static_map", &WorldMapNode::onStaticMap, this),
               private_node.advertiseService("get_region", &WorldMapNode::onGetRegion, this),
               private_node.advertiseService("save_map", &WorldMapNode::onSaveMap, this),
               private_node.advertiseService("load_map", &WorldMapNode::onLoadMap, this)};
}

void WorldMapNode::subscribe() {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  const auto subscribeTo = [&](const char* topic, const auto* message_type, const auto& convert) {
    using Message = std::remove_const_t<std::remove_pointer_t<decltype(message_type)>>;
    const boost::function<void(const Message&)> callback = [this, convert](const Message& message) {
      store(message, convert);
    };
    subscribers_.push_back(
        node_.subscribe<Message>(topic, 10, callback, ros::VoidConstPtr(), hints));
  };
  subscribeTo("map", static_cast<nav_msgs::OccupancyGrid*>(nullptr), &toOccupancyOfWholeMap);
  subscribeTo("local_occupancy", static_cast<ram_slam_msgs::LocalOccupancy*>(nullptr),
              &toLocalOccupancy);
  subscribeTo("landmarks", static_cast<ram_slam_msgs::LandmarkMap*>(nullptr), &toLandmarkLayer);
  subscribeTo("colored_cloud", static_cast<ram_slam_msgs::ColoredCloud*>(nullptr), &toColoredCloud);
  subscribeTo("trajectory", static_cast<nav_msgs::Path*>(nullptr), &toTrajectory);
}

template <typename Message, typename Convert>
void WorldMapNode::store(const Message& message, const Convert& convert) {
  try {
    if (message.header.frame_id != parameters_.map_frame) {
      throw std::invalid_argument("its frame is '" + message.header.frame_id + "', not '" +
                                  parameters_.map_frame + "'");
    }
    auto part = convert(message);
    const std::lock_guard lock(map_mutex_);
    map_.put(std::move(part));
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Refused a " << ros::message_traits::datatype<Message>()
                                                       << ": " << error.what());
  }
}

NodeDiagnostics::Report WorldMapNode::report() {
  NodeDiagnostics::Report report;
  report.state = parameters_.read_only ? "the saved map is published" : "what comes is stored";
  addDiskCause(parameters_.map_folder, report.causes);
  const std::lock_guard lock(map_mutex_);
  report.values = {{"grids", static_cast<double>(map_.occupancies().size())},
                   {"landmarks", static_cast<double>(map_.landmarks().landmarks.size())}};
  return report;
}

ram_slam::WorldMap WorldMapNode::snapshot() {
  const std::lock_guard lock(map_mutex_);
  return map_;
}

std::string WorldMapNode::pathOf(const std::string& name) const {
  return ram_slam::pathInFolder(ram_slam::expandHome(parameters_.map_folder), name);
}

nav_msgs::OccupancyGrid WorldMapNode::wholeGrid() {
  const ram_slam::WorldMap map = snapshot();
  const auto whole = map.occupancies().find(parameters_.map_frame);
  if (whole == map.occupancies().end()) return {};
  return toOccupancyGridMessage(whole->second->grid, parameters_.map_frame,
                                whole->second->stamp_ns);
}

void WorldMapNode::publishMap() {
  const nav_msgs::OccupancyGrid grid = wholeGrid();
  if (grid.data.empty()) return;
  map_publisher_.publish(grid);
  metadata_publisher_.publish(grid.info);
}

bool WorldMapNode::onStaticMap(nav_msgs::GetMap::Request& /*request*/,
                               nav_msgs::GetMap::Response& response) {
  response.map = wholeGrid();
  return !response.map.data.empty();
}

std::string WorldMapNode::addDrawnMap(ram_slam::WorldMap& map) {
  ram_slam_msgs::GetDrawnMap drawn;
  const std::string service = node_.resolveName(kDrawnMapService);
  if (!ros::service::exists(service, false) || !ros::service::call(service, drawn))
    return "; without scans, for want of " + service + ": no robot can continue it";
  if (!drawn.response.map.data.empty()) map.put(toOccupancyOfWholeMap(drawn.response.map));
  std::vector<ram_slam::PlacedScan> scans;
  scans.reserve(drawn.response.scans.size());
  for (const ram_slam_msgs::KeyScan& scan : drawn.response.scans)
    scans.push_back(toPlacedScan(scan));
  map.put(std::move(scans));
  if (drawn.response.settled_count == 0) return "";
  return "; " + std::to_string(drawn.response.settled_count) +
         " scans of its grid are missing, which occupancy_mapper no longer keeps (max_scan_count)";
}

bool WorldMapNode::onGetRegion(ram_slam_msgs::GetRegion::Request& request,
                               ram_slam_msgs::GetRegion::Response& response) {
  try {
    response = toRegionResponse(
        snapshot().region({request.min_x, request.min_y, request.max_x, request.max_y}),
        parameters_.map_frame);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  return true;
}

bool WorldMapNode::onSaveMap(ram_slam_msgs::SaveMap::Request& request,
                             ram_slam_msgs::SaveMap::Response& response) {
  const std::lock_guard one_at_a_time(file_mutex_);
  try {
    const std::string path = pathOf(request.name);
    ram_slam::WorldMap map = snapshot();
    const std::string missing = parameters_.read_only ? "" : addDrawnMap(map);
    if (map.empty()) throw std::runtime_error("there is no map yet");
    ram_slam::saveMapFolder(map, parameters_.map_frame, path);
    response.success = true;
    response.message = "saved " + path + missing;
    ROS_INFO_STREAM(response.message);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_ERROR_STREAM("The world map was not saved: " << error.what());
  }
  return true;
}

bool WorldMapNode::onLoadMap(ram_slam_msgs::LoadMap::Request& request,
                             ram_slam_msgs::LoadMap::Response& response) {
  const std::lock_guard one_at_a_time(file_mutex_);
  try {
    std::string path = pathOf(request.name);
    if (parameters_.read_only)
      throw std::runtime_error("the map is read only; start with another initial_map");
    if (!std::filesystem::exists(path) && std::filesystem::exists(path + kOldExtension))
      path += kOldExtension;
    ram_slam::WorldMap map = ram_slam::loadWorldMap(path);
    const std::lock_guard lock(map_mutex_);
    map_ = std::move(map);
    response.success = true;
    response.message = "loaded " + path;
    ROS_INFO_STREAM(response.message);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_ERROR_STREAM("No world map was loaded: " << error.what());
  }
  return true;
}

}  // namespace ram_slam_ros
