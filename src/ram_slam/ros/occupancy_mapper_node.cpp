// SPDX-License-Identifier: BSD-3-Clause
#include "occupancy_mapper_node.hpp"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/occupancy/map_file.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/mounting.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

namespace ram_slam_ros {
namespace {

constexpr std::size_t kMaxWaiting = 1000;
constexpr std::int64_t kTimeJumpNs = 1000000000;
constexpr double kWaitingPollS = 0.02;
constexpr double kSilenceReportS = 5.0;
constexpr double kWarnPeriodS = 5.0;
constexpr std::uint32_t kQueueSize = 100;

std::string expandHome(const std::string& path) {
  const char* home = std::getenv("HOME");
  if (home == nullptr || (path != "~" && path.compare(0, 2, "~/") != 0)) return path;
  return home + path.substr(1);
}

}  // namespace

OccupancyMapperNode::OccupancyMapperNode(ram_parameters::ParameterReader& reader)
    : parameters_(ram_slam::readOccupancyMapperParameters(reader)), map_(parameters_) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  constexpr bool kLatched = true;
  map_publisher_ = node_.advertise<nav_msgs::OccupancyGrid>("map", 1, kLatched);
  metadata_publisher_ = node_.advertise<nav_msgs::MapMetaData>("map_metadata", 1, kLatched);
  update_publisher_ = node_.advertise<map_msgs::OccupancyGridUpdate>("map_updates", kQueueSize);
  dynamic_map_service_ =
      node_.advertiseService("dynamic_map", &OccupancyMapperNode::onDynamicMap, this);
  save_map_service_ =
      private_node_.advertiseService("save_map", &OccupancyMapperNode::onSaveMap, this);
  reset_service_ = private_node_.advertiseService("reset", &OccupancyMapperNode::onReset, this);
  scan_subscriber_ = node_.subscribe("scan", kQueueSize, &OccupancyMapperNode::onScan, this, hints);
  correction_subscriber_ =
      node_.subscribe("corrected_trajectory", 1, &OccupancyMapperNode::onTrajectory, this, hints);
  if (parameters_.follow_trajectory) {
    trajectory_subscriber_ =
        node_.subscribe("trajectory", 1, &OccupancyMapperNode::onTrajectory, this, hints);
  }
  publish_timer_ = node_.createTimer(ros::Duration(parameters_.publish_period_s),
                                     [this](const auto&) { publishMap(); });
  update_timer_ = node_.createTimer(ros::Duration(parameters_.update_period_s),
                                    [this](const auto&) { publishUpdate(); });
  waiting_timer_ = node_.createWallTimer(ros::WallDuration(kWaitingPollS),
                                         [this](const auto&) { mapWaiting(); });
  silence_timer_ = node_.createWallTimer(ros::WallDuration(kSilenceReportS),
                                         [this](const auto&) { reportSilence(); });
  ROS_INFO_STREAM("mapping " << scan_subscriber_.getTopic() << " at " << parameters_.resolution
                             << " m into " << map_publisher_.getTopic() << " in frame "
                             << parameters_.map_frame << "; corrections from "
                             << correction_subscriber_.getTopic());
}

void OccupancyMapperNode::onScan(const sensor_msgs::LaserScan& message) {
  try {
    ram_slam::LaserScan scan = toLaserScan(message);
    const std::lock_guard lock(map_mutex_);
    ++received_count_;
    if (scan.stamp_ns < newest_scan_ns_ - kTimeJumpNs) {
      ROS_WARN_STREAM("time jumped back by "
                      << static_cast<double>(newest_scan_ns_ - scan.stamp_ns) * 1e-9
                      << " s: the map starts anew");
      startAnew();
    }
    newest_scan_ns_ = std::max(newest_scan_ns_, scan.stamp_ns);
    waiting_.push_back({std::move(scan), message.header.frame_id, ros::SteadyTime::now()});
  } catch (const std::exception& error) {
    const std::lock_guard lock(map_mutex_);
    ++received_count_;
    last_problem_ = error.what();
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "rejected a scan: " << error.what());
  }
  mapWaiting();
}

void OccupancyMapperNode::mapWaiting() {
  const std::lock_guard lock(map_mutex_);
  while (!waiting_.empty()) {
    const Waiting& first = waiting_.front();
    const double waited_s = (ros::SteadyTime::now() - first.since).toSec();
    const bool waits =
        waited_s <= parameters_.transform_timeout_s && waiting_.size() <= kMaxWaiting;
    const auto knows = [&](std::int64_t stamp_ns) {
      return transforms_.canTransform(parameters_.map_frame, first.frame, toTime(stamp_ns),
                                      ros::Duration(0.0), &last_problem_);
    };
    if (waits && !knows(first.scan.stamp_ns + first.scan.duration_ns())) return;
    if (knows(first.scan.stamp_ns)) {
      map(first.scan, first.frame);
    } else {
      if (waits) return;
      ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "dropped a scan that waited "
                                                 << waited_s
                                                 << " s for its pose: " << last_problem_);
    }
    waiting_.pop_front();
  }
}

void OccupancyMapperNode::map(const ram_slam::LaserScan& scan, const std::string& frame) {
  try {
    const Mounting mounting =
        toMounting(transforms_.lookupTransform(parameters_.base_frame, frame, toTime(scan.stamp_ns))
                       .transform);
    const auto counts =
        map_.add(mounting.upside_down ? ram_slam::mirrored(scan) : scan, poseAt(scan.stamp_ns),
                 mounting.base_from_sensor, lastBeam(scan, mounting.base_from_sensor));
    newest_mapped_ns_ = scan.stamp_ns;
    if (!ever_mapped_) ROS_INFO_STREAM("first scan mapped, from frame " << frame);
    ever_mapped_ = true;
    if (counts && counts->hit + counts->cleared == 0) {
      ROS_WARN_STREAM_THROTTLE(
          kWarnPeriodS, "a scan had no usable reading: " << counts->too_close << " too close, "
                                                         << counts->invalid << " invalid");
    }
  } catch (const std::exception& error) {
    last_problem_ = error.what();
    ROS_WARN_STREAM_THROTTLE(kWarnPeriodS, "skipped a scan: " << error.what());
  }
}

ram_slam::Pose2 OccupancyMapperNode::poseAt(std::int64_t stamp_ns) const {
  return toPose2(
      transforms_.lookupTransform(parameters_.map_frame, parameters_.base_frame, toTime(stamp_ns))
          .transform);
}

ram_slam::Pose2 OccupancyMapperNode::lastBeam(const ram_slam::LaserScan& scan,
                                              const ram_slam::Pose2& base_from_laser) const {
  const std::int64_t end_ns = scan.stamp_ns + scan.duration_ns();
  if (!transforms_.canTransform(parameters_.map_frame, parameters_.base_frame, toTime(end_ns)))
    return {};
  const ram_slam::Pose2 map_from_laser = poseAt(scan.stamp_ns) * base_from_laser;
  return map_from_laser.inverse() * poseAt(end_ns) * base_from_laser;
}

void OccupancyMapperNode::onTrajectory(const nav_msgs::Path& message) {
  try {
    if (message.header.frame_id != parameters_.map_frame) {
      throw std::invalid_argument("its frame is '" + message.header.frame_id + "', not '" +
                                  parameters_.map_frame + "'");
    }
    const ram_slam::Trajectory trajectory = toTrajectory(message);
    int moved_count = 0;
    {
      const std::lock_guard lock(map_mutex_);
      moved_count = map_.correct(trajectory);
    }
    if (moved_count == 0) return;
    ROS_INFO_STREAM("trajectory corrected: " << moved_count << " scans moved, map redrawn");
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(
        kWarnPeriodS, "a corrected trajectory was not followed to its end: " << error.what());
  }
  publishMap();
}

void OccupancyMapperNode::startAnew() {
  map_ = ram_slam::KeyScanMap(parameters_);
  ++map_generation_;
  waiting_.clear();
  transforms_.clear();
  newest_scan_ns_ = 0;
}

ram_slam::GridChange OccupancyMapperNode::refreshGrid() {
  const std::lock_guard lock(map_mutex_);
  if (grid_generation_ != map_generation_) {
    grid_ = {};
    grid_revision_ = 0;
    grid_generation_ = map_generation_;
  }
  const ram_slam::GridChange change = map_.mapper().refresh(grid_, grid_revision_);
  grid_revision_ = map_.mapper().revision();
  grid_stamp_ns_ = newest_mapped_ns_;
  return change;
}

ram_slam::OccupancyGrid OccupancyMapperNode::wholeGrid() {
  const std::lock_guard lock(map_mutex_);
  return map_.mapper().grid();
}

void OccupancyMapperNode::publishMap() {
  const std::lock_guard lock(publish_mutex_);
  refreshGrid();
  if (grid_.width == 0) return;
  const nav_msgs::OccupancyGrid message =
      toOccupancyGridMessage(grid_, parameters_.map_frame, grid_stamp_ns_);
  map_publisher_.publish(message);
  metadata_publisher_.publish(message.info);
}

void OccupancyMapperNode::publishUpdate() {
  {
    const std::lock_guard lock(publish_mutex_);
    const ram_slam::GridChange change = refreshGrid();
    if (change.width == 0) return;
    if (!change.whole) {
      update_publisher_.publish(
          toUpdateMessage(grid_, change, parameters_.map_frame, grid_stamp_ns_));
      return;
    }
  }
  publishMap();
}

bool OccupancyMapperNode::onDynamicMap(nav_msgs::GetMap::Request&,
                                       nav_msgs::GetMap::Response& response) {
  const ram_slam::OccupancyGrid grid = wholeGrid();
  response.map = toOccupancyGridMessage(grid, parameters_.map_frame, newest_mapped_ns_);
  return true;
}

bool OccupancyMapperNode::onSaveMap(ram_slam_msgs::SaveMap::Request& request,
                                    ram_slam_msgs::SaveMap::Response& response) {
  const std::lock_guard one_at_a_time(save_mutex_);
  try {
    const std::string folder = expandHome(parameters_.map_folder);
    const std::string stem = ram_slam::pathInFolder(folder, request.name);
    const ram_slam::OccupancyGrid grid = wholeGrid();
    if (grid.width == 0) throw std::runtime_error("there is no map yet");
    std::filesystem::create_directories(folder);
    ram_slam::saveMap(grid, stem);
    response.success = true;
    response.message = "saved " + stem + ".pgm and " + stem + ".yaml";
    ROS_INFO_STREAM(response.message);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_ERROR_STREAM("the map was not saved: " << error.what());
  }
  return true;
}

bool OccupancyMapperNode::onReset(std_srvs::Trigger::Request&,
                                  std_srvs::Trigger::Response& response) {
  const std::lock_guard lock(map_mutex_);
  startAnew();
  response.success = true;
  response.message = "the map starts anew";
  ROS_INFO_STREAM(response.message);
  return true;
}

void OccupancyMapperNode::reportSilence() {
  const std::lock_guard lock(map_mutex_);
  if (received_count_ == 0) {
    ROS_WARN_STREAM_THROTTLE(6 * kSilenceReportS, "no scan on " << scan_subscriber_.getTopic()
                                                                << " for " << kSilenceReportS
                                                                << " s");
  } else if (!ever_mapped_) {
    ROS_WARN_STREAM_THROTTLE(6 * kSilenceReportS,
                             "scans arrive, but none could be mapped: " << last_problem_);
  }
  received_count_ = 0;
}

}  // namespace ram_slam_ros
