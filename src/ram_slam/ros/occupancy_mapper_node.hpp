// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include <nav_msgs/GetMap.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/GetDrawnMap.h>
#include <ram_slam_msgs/SaveMap.h>
#include <ram_slam_msgs/Tracking.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/ros/node_diagnostics.hpp"
#include "ram_slam/stages/mapping_stage.hpp"

#include "mounted_scans.hpp"

namespace ram_slam_ros {

/// Scans and tf in, occupancy map out: `map` and `map_metadata` (latched), `map_updates`, services
/// `dynamic_map`,
/// `~get_drawn_map`, `~save_map`, `~reset`. Redraws the map when a `corrected_trajectory` arrives;
/// leaves out what a lost robot sees (`tracking`).
///
/// Made for several callback threads: drawing a message or writing a file holds the map no longer
/// than copying what changed takes.
class OccupancyMapperNode {
public:
  /// \throws std::invalid_argument if a parameter is refused
  explicit OccupancyMapperNode(ram_parameters::ParameterReader& reader);

private:
  void onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event);
  void onTrajectory(const nav_msgs::Path& message);
  void onTracking(const ram_slam_msgs::Tracking& message);
  bool onGetDrawnMap(ram_slam_msgs::GetDrawnMap::Request& request,
                     ram_slam_msgs::GetDrawnMap::Response& response);
  bool onDynamicMap(nav_msgs::GetMap::Request& request, nav_msgs::GetMap::Response& response);
  bool onSaveMap(ram_slam_msgs::SaveMap::Request& request,
                 ram_slam_msgs::SaveMap::Response& response);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  /// Hands waiting scans on to the stage whose poses are known; drops those that waited too long.
  void mapWaiting();
  /// The caller holds map_mutex_. \return false if the scan still waits for its pose
  bool map(const ram_slam::MountedScan& scan, double waited_s);
  /// Of the base in the map. \throws tf2::TransformException
  ram_slam::Pose2 poseAt(std::int64_t stamp_ns) const;
  /// The laser's pose at its last beam, seen from that at its first; the identity if tf does not
  /// reach so far.
  ram_slam::Pose2 lastBeam(const ram_slam::MountedScan& scan,
                           const ram_slam::Pose2& map_from_base) const;
  /// Begins with an empty map; the caller holds map_mutex_.
  void restart();
  void publishMap();
  void publishUpdate();
  NodeDiagnostics::Report report();
  /// Brings grid_ up to date; the caller holds publish_mutex_.
  ram_slam::GridChange refreshGrid();
  ram_slam::OccupancyGrid wholeGrid();

  ram_slam::OccupancyMapperParameters parameters_;
  ros::NodeHandle node_;
  ros::NodeHandle private_node_{"~"};
  /// A scan whose pose is not known yet.
  struct Waiting {
    ram_slam::MountedScan scan;
    ros::SteadyTime since;
  };

  // Longer than tf's usual: a recording may be played many times faster than real time.
  tf2_ros::Buffer transforms_{ros::Duration(60.0)};
  tf2_ros::TransformListener transform_listener_{transforms_};

  std::mutex map_mutex_;  ///< of the members up to the next blank line
  ram_slam::MappingStage stage_;
  MountedScans scans_;
  std::deque<Waiting> waiting_;
  std::atomic<std::int64_t> newest_mapped_ns_ = 0;
  bool is_lost_ = false;
  bool ever_mapped_ = false;
  std::string last_problem_ = "no transform yet";
  DropLog drop_log_;

  std::mutex
      publish_mutex_;  ///< of the members up to the next blank line; locked before map_mutex_
  ram_slam::OccupancyGrid grid_;
  int grid_generation_ = 0;  ///< resets of the stage that it has followed
  std::uint64_t grid_revision_ = 0;
  std::int64_t grid_stamp_ns_ = 0;

  std::mutex save_mutex_;  ///< one save at a time

  ros::Publisher map_publisher_;
  ros::Publisher metadata_publisher_;
  ros::Publisher update_publisher_;
  ros::ServiceServer dynamic_map_service_;
  ros::ServiceServer drawn_map_service_;
  ros::ServiceServer save_map_service_;
  ros::ServiceServer reset_service_;
  ros::Subscriber scan_subscriber_;
  ros::Subscriber correction_subscriber_;
  ros::Subscriber trajectory_subscriber_;
  ros::Subscriber tracking_subscriber_;
  ros::Timer publish_timer_;
  ros::Timer update_timer_;
  ros::WallTimer waiting_timer_;
  NodeDiagnostics diagnostics_;
  NodeDiagnostics::Input* scan_input_ = nullptr;
};

}  // namespace ram_slam_ros
