// SPDX-License-Identifier: BSD-3-Clause
#include "occupancy_mapper_node.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <utility>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/occupancy/map_file.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
OccupancyMapperNode::OccupancyMapperNode(ram_parameters::ParameterReader& reader)
    : parameters_(ram_slam::readOccupancyMapperParameters(reader)),
      stage_(parameters_, loadScans(parameters_.initial_map)),
      scans_(parameters_.base_frame, transforms_),
      diagnostics_(ram_slam::Link::kMap, "mapping", [this] { return report(); }) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  map_publisher_ = node_.advertise<nav_msgs::OccupancyGrid>("map", 1, kLatched);
  metadata_publisher_ = node_.advertise<nav_msgs::MapMetaData>("map_metadata", 1, kLatched);
  update_publisher_ = node_.advertise<map_msgs::OccupancyGridUpdate>("map_updates", kQueueSize);
  dynamic_map_service_ =
      node_.advertiseService("dynamic_map", &OccupancyMapperNode::onDynamicMap, this);
  drawn_map_service_ =
      private_node_.advertiseService("get_drawn_map", &OccupancyMapperNode::onGetDrawnMap, this);
  save_map_service_ =
      private_node_.advertiseService("save_map", &OccupancyMapperNode::onSaveMap, this);
  reset_service_ = private_node_.advertiseService("reset", &OccupancyMapperNode::onReset, this);
  scan_subscriber_ = node_.subscribe("scan", kQueueSize, &OccupancyMapperNode::onScan, this, hints);
  scans_.followCalibration(node_);
  correction_subscriber_ =
      node_.subscribe("corrected_trajectory", 1, &OccupancyMapperNode::onTrajectory, this, hints);
  tracking_subscriber_ =
      node_.subscribe("tracking", 10, &OccupancyMapperNode::onTracking, this, hints);
  if (parameters_.follow_trajectory) {
    trajectory_subscriber_ =
        node_.subscribe("trajectory", 1, &OccupancyMapperNode::onTrajectory, this, hints);
  }
  publish_timer_ = node_.createTimer(ros::Duration(parameters_.publish_period_s),
                                     [this](const auto&) { publishMap(); });
  update_timer_ = node_.createTimer(ros::Duration(parameters_.update_period_s),
                                    [this](const auto&) { publishUpdate(); });
  waiting_timer_ = node_.createWallTimer(ros::WallDuration(parameters_.waiting_poll_s),
                                         [this](const auto&) { mapWaiting(); });
  scan_input_ = &diagnostics_.watch<sensor_msgs::LaserScan>(scan_subscriber_, scanInput());
  diagnostics_.needMount(transforms_, parameters_.base_frame);
  diagnostics_.need(transforms_, {parameters_.map_frame, "", parameters_.base_frame, "",
                                  "the estimator publishes " + parameters_.map_frame +
                                      " -> odom, the robot the rest; see what fast_slam reports",
                                  ram_slam::Link::kPose});
  diagnostics_.setOutput(map_publisher_.getTopic(), 2.0 + parameters_.transform_timeout_s);
  ROS_INFO_STREAM("Mapping " << scan_subscriber_.getTopic() << " at " << parameters_.resolution
                             << " m into " << map_publisher_.getTopic() << " in frame "
                             << parameters_.map_frame << "; corrections from "
                             << correction_subscriber_.getTopic());
}

NodeDiagnostics::Report OccupancyMapperNode::report() {
  NodeDiagnostics::Report report;
  {
    const std::lock_guard lock(map_mutex_);
    report.drops = stage_.drops();
    report.values = {{"scans in the map", static_cast<double>(stage_.scanCount())}};
    report.messages = scans_.messages();
    const auto most = static_cast<std::size_t>(parameters_.max_scan_count);
    if (10 * stage_.scanCount() >= 9 * most) {
      report.causes.push_back({ram_slam::Link::kMap, ram_slam::Severity::kWarning, "many scans",
                               std::to_string(stage_.scanCount()) + " of " + std::to_string(most) +
                                   " scans are kept (max_scan_count): of more, the oldest stay "
                                   "where they are drawn and are missing in saved maps"});
    }
    if (is_lost_) {
      report.causes.push_back({ram_slam::Link::kPose, ram_slam::Severity::kWarning, "lost",
                               "the robot is lost: no scans are drawn until it is found"});
    }
  }
  addDiskCause(parameters_.map_folder, report.causes);
  return report;
}

void OccupancyMapperNode::onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event) {
  diagnostics_.arrived(*scan_input_, event);
  {
    const std::lock_guard lock(map_mutex_);
    const std::uint64_t drops_before = stage_.drops().total();
    const bool is_set_back = scans_.add(event, stage_.drops());
    diagnostics_.refusedIfDropped(*scan_input_, stage_.drops(), drops_before);
    if (is_set_back) {
      ROS_WARN_STREAM("The stamps on " << scan_subscriber_.getTopic()
                                       << " were set back: the map starts again");
      restart();
    }
  }
  mapWaiting();
}

void OccupancyMapperNode::mapWaiting() {
  const std::lock_guard lock(map_mutex_);
  while (auto scan = scans_.next(stage_.drops())) {
    waiting_.push_back({std::move(*scan), ros::SteadyTime::now()});
  }
  while (!waiting_.empty()) {
    const double waited_s = (ros::SteadyTime::now() - waiting_.front().since).toSec();
    if (!map(waiting_.front().scan, waited_s)) break;
    waiting_.pop_front();
  }
  drop_log_.log(stage_.drops(), scan_subscriber_.getTopic());
}

bool OccupancyMapperNode::map(const ram_slam::MountedScan& scan, double waited_s) {
  const std::int64_t stamp_ns = scan.scan.stamp_ns;
  const bool waits = waited_s <= parameters_.transform_timeout_s && waiting_.size() <= kQueueSize;
  const auto knows = [&](std::int64_t at_ns) {
    return transforms_.canTransform(parameters_.map_frame, parameters_.base_frame, toTime(at_ns),
                                    ros::Duration(0.0), &last_problem_);
  };
  if (waits && !knows(stamp_ns + scan.scan.duration_ns())) return false;
  if (!knows(stamp_ns)) {
    if (waits) return false;
    stage_.drops().add(ram_slam::DropReason::kNoPose, stamp_ns, last_problem_);
    return true;
  }
  try {
    const ram_slam::Pose2 map_from_base = poseAt(stamp_ns);
    stage_.add(scan, map_from_base, lastBeam(scan, map_from_base));
    newest_mapped_ns_ = stamp_ns;
    diagnostics_.answered(stamp_ns);
    if (!ever_mapped_) ROS_INFO_STREAM("Mapped the first scan of " << scan_subscriber_.getTopic());
    ever_mapped_ = true;
  } catch (const std::exception& error) {
    stage_.drops().add(ram_slam::DropReason::kNoPose, stamp_ns, error.what());
  }
  return true;
}

ram_slam::Pose2 OccupancyMapperNode::poseAt(std::int64_t stamp_ns) const {
  return toPose2(
      transforms_.lookupTransform(parameters_.map_frame, parameters_.base_frame, toTime(stamp_ns))
          .transform);
}

ram_slam::Pose2 OccupancyMapperNode::lastBeam(const ram_slam::MountedScan& scan,
                                              const ram_slam::Pose2& map_from_base) const {
  const std::int64_t end_ns = scan.scan.stamp_ns + scan.scan.duration_ns();
  if (!transforms_.canTransform(parameters_.map_frame, parameters_.base_frame, toTime(end_ns)))
    return {};
  const ram_slam::Pose2 map_from_laser = map_from_base * scan.base_from_laser;
  return map_from_laser.inverse() * poseAt(end_ns) * scan.base_from_laser;
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
      moved_count = stage_.correct(trajectory);
    }
    if (moved_count == 0) return;
    ROS_INFO_STREAM("Corrected the map along " << correction_subscriber_.getTopic() << ": "
                                               << moved_count << " scans moved");
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Did not follow a trajectory: " << error.what());
  }
  publishMap();
}

void OccupancyMapperNode::onTracking(const ram_slam_msgs::Tracking& message) {
  int removed_count = 0;
  try {
    const ram_slam::Tracking tracking = toTracking(message, parameters_.map_frame);
    const std::lock_guard lock(map_mutex_);
    removed_count = stage_.set(tracking);
    is_lost_ = tracking.is_lost;
  } catch (const std::exception& error) {
    ROS_WARN_STREAM("Refused a message on " << tracking_subscriber_.getTopic() << ": "
                                            << error.what());
    return;
  }
  if (message.lost) {
    ROS_WARN_STREAM("The robot is lost: took " << removed_count
                                               << " scans out, no scans are drawn until it is "
                                                  "found ("
                                               << tracking_subscriber_.getTopic() << ")");
  }
  if (removed_count > 0) publishMap();
}

void OccupancyMapperNode::restart() {
  stage_.reset();
  waiting_.clear();
  // tf ignores transforms of a clock that was set back until it is cleared.
  transforms_.clear();
}

ram_slam::GridChange OccupancyMapperNode::refreshGrid() {
  const std::lock_guard lock(map_mutex_);
  if (grid_generation_ != stage_.resetCount()) {
    grid_ = {};
    grid_revision_ = 0;
    grid_generation_ = stage_.resetCount();
  }
  const ram_slam::BeamCounts drawn = stage_.draw();
  if (drawn.hit + drawn.cleared == 0 && drawn.too_close + drawn.invalid > 0) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "No usable reading on " << scan_subscriber_.getTopic()
                                                                  << ": " << drawn.too_close
                                                                  << " too close, " << drawn.invalid
                                                                  << " invalid");
  }
  const ram_slam::GridChange change = stage_.mapper().refresh(grid_, grid_revision_);
  grid_revision_ = stage_.mapper().revision();
  grid_stamp_ns_ = newest_mapped_ns_;
  return change;
}

ram_slam::OccupancyGrid OccupancyMapperNode::wholeGrid() {
  const std::lock_guard lock(map_mutex_);
  stage_.draw();
  return stage_.mapper().grid();
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

bool OccupancyMapperNode::onGetDrawnMap(ram_slam_msgs::GetDrawnMap::Request&,
                                        ram_slam_msgs::GetDrawnMap::Response& response) {
  ram_slam::OccupancyGrid grid;
  std::vector<ram_slam::PlacedScan> scans;
  {
    const std::lock_guard lock(map_mutex_);
    stage_.draw();
    grid = stage_.mapper().grid();
    scans = stage_.scans();
    response.settled_count = static_cast<std::uint32_t>(stage_.settledCount());
  }
  response.map = toOccupancyGridMessage(grid, parameters_.map_frame, newest_mapped_ns_);
  response.scans.reserve(scans.size());
  for (const ram_slam::PlacedScan& placed : scans)
    response.scans.push_back(toKeyScanMessage(placed));
  return true;
}

bool OccupancyMapperNode::onSaveMap(ram_slam_msgs::SaveMap::Request& request,
                                    ram_slam_msgs::SaveMap::Response& response) {
  const std::lock_guard one_at_a_time(save_mutex_);
  try {
    const std::string folder = ram_slam::expandHome(parameters_.map_folder);
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
    ROS_ERROR_STREAM("The map was not saved: " << error.what());
  }
  return true;
}

bool OccupancyMapperNode::onReset(std_srvs::Trigger::Request&,
                                  std_srvs::Trigger::Response& response) {
  const std::lock_guard lock(map_mutex_);
  scans_.clear();
  restart();
  response.success = true;
  response.message = "the map starts again";
  ROS_INFO_STREAM(response.message);
  return true;
}

}  // namespace ram_slam_ros
