// SPDX-License-Identifier: BSD-3-Clause
#include "world_map_node.hpp"

#include <exception>
#include <filesystem>
#include <stdexcept>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"
#include "ram_slam/world_map/world_map_file.hpp"

#include "node_defaults.hpp"
#include "world_map_conversions.hpp"

namespace ram_slam_ros {
namespace {

constexpr const char* kExtension = ".world";

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
}

WorldMapNodeParameters readWorldMapNodeParameters(ram_parameters::ParameterReader& reader) {
  WorldMapNodeParameters parameters;
  reader.read("map_frame", parameters.map_frame);
  reader.read("map_folder", parameters.map_folder);
  reader.rejectUnknown();
  parameters.validate();
  return parameters;
}

WorldMapNode::WorldMapNode(ram_parameters::ParameterReader& reader)
    : parameters_(readWorldMapNodeParameters(reader)) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  const auto subscribe = [&](const char* topic, const auto* message_type, const auto& convert) {
    using Message = std::remove_const_t<std::remove_pointer_t<decltype(message_type)>>;
    const boost::function<void(const Message&)> callback = [this, convert](const Message& message) {
      store(message, convert);
    };
    subscribers_.push_back(
        node_.subscribe<Message>(topic, 10, callback, ros::VoidConstPtr(), hints));
  };
  subscribe("map", static_cast<nav_msgs::OccupancyGrid*>(nullptr), &toOccupancyOfWholeMap);
  subscribe("local_occupancy", static_cast<ram_slam_msgs::LocalOccupancy*>(nullptr),
            &toLocalOccupancy);
  subscribe("landmarks", static_cast<ram_slam_msgs::LandmarkMap*>(nullptr), &toLandmarkLayer);
  subscribe("colored_cloud", static_cast<ram_slam_msgs::ColoredCloud*>(nullptr), &toColoredCloud);
  subscribe("trajectory", static_cast<nav_msgs::Path*>(nullptr), &toTrajectory);

  ros::NodeHandle private_node("~");
  services_ = {private_node.advertiseService("get_region", &WorldMapNode::onGetRegion, this),
               private_node.advertiseService("save_map", &WorldMapNode::onSaveMap, this),
               private_node.advertiseService("load_map", &WorldMapNode::onLoadMap, this)};
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

ram_slam::WorldMap WorldMapNode::snapshot() {
  const std::lock_guard lock(map_mutex_);
  return map_;
}

std::string WorldMapNode::pathOf(const std::string& name) const {
  return ram_slam::pathInFolder(ram_slam::expandHome(parameters_.map_folder), name) + kExtension;
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
    const ram_slam::WorldMap map = snapshot();
    if (map.empty()) throw std::runtime_error("there is no map yet");
    std::filesystem::create_directories(ram_slam::expandHome(parameters_.map_folder));
    ram_slam::writeFileAtomically(path, ram_slam::toBytes(map));
    response.success = true;
    response.message = "saved " + path;
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
    const std::string path = pathOf(request.name);
    ram_slam::WorldMap map;
    try {
      map = ram_slam::worldMapFromBytes(ram_slam::readWholeFile(path));
    } catch (const std::system_error&) {
      throw;  // names the file itself
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(path + ": " + error.what());
    }
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
