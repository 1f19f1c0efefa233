// SPDX-License-Identifier: BSD-3-Clause
#include "fast_slam_node.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>

#include <geometry_msgs/PoseArray.h>
#include <nav_msgs/Path.h>
#include <std_msgs/Bool.h>

#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/landmark_conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"
#include "ram_slam/world_map/landmark_layer.hpp"
#include "ram_slam/world_map/world_map_file.hpp"

namespace ram_slam_ros {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr double kLogPeriodS = 5.0;
constexpr std::size_t kMostQueued = 500;
constexpr std::int64_t kClockSetBackNs = 1'000'000'000;
/// How long a list waits for the odometry that it needs, in wall time; shorter while odometry is
/// known to be missing.
constexpr auto kPatience = milliseconds(1000);
constexpr auto kPatienceInterrupted = milliseconds(20);
constexpr auto kFirstRetry = milliseconds(2);
constexpr auto kLongestRetry = milliseconds(100);
constexpr auto kServicePatience = milliseconds(200);
/// Least standard deviations of an initial pose [m], [rad]: nobody clicks more exactly.
constexpr double kInitialSigma_m = 0.01;
constexpr double kInitialSigma_rad = 0.005;
/// Corrections of the pose that are told: consumers see it jump.
constexpr double kToldCorrection_m = 0.2;
constexpr double kToldCorrection_rad = 0.1;
constexpr std::size_t kMostMapBytes = std::size_t{1} << 31;

void tellOfCorrection(const ram_slam::Pose2& before, const ram_slam::Pose2& after) {
  const ram_slam::Pose2 correction = before.inverse() * after;
  const double moved_m = correction.translation().norm();
  if (moved_m < kToldCorrection_m && std::abs(correction.yaw_rad) < kToldCorrection_rad) return;
  ROS_WARN_STREAM("The smoothed trajectory moves the pose by " << moved_m << " m and turns it by "
                                                               << correction.yaw_rad
                                                               << " rad, and the map with it");
}

}  // namespace

FastSlamNode::FastSlamNode(ram_parameters::ParameterReader& reader)
    : node_parameters_(readFastSlamNodeParameters(reader)),
      parameters_(ram_slam::readFastSlamParameters(reader)),
      recovery_parameters_(ram_slam::readRecoveryParameters(reader)),
      views_(node_parameters_.frames.base, buffer_),
      map_to_odom_(node_parameters_.frames, parameters_.future_interpol, buffer_),
      kinematics_(node_),
      motion_(kinematics_),
      checkpoints_(node_parameters_.checkpoint_file, node_parameters_.checkpoint_period),
      filter_(makeFilter()) {
  advertise();
  if (!goOnFromCheckpoint()) loadInitialMap();
  publishLost();
  thread_ = std::thread([this] { run(); });
  subscribe();
}

FastSlamNode::~FastSlamNode() {
  subscribers_.clear();
  stop_ = true;
  queue_changed_.notify_all();
  thread_.join();
  checkpoints_.remove();  // it was not killed
}

void FastSlamNode::advertise() {
  pose_ = node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 10);
  particles_ = node_.advertise<geometry_msgs::PoseArray>("particlecloud", 2);
  landmarks_ = node_.advertise<ram_slam_msgs::LandmarkMap>("landmarks", 1, true);
  landmark_markers_ = node_.advertise<visualization_msgs::MarkerArray>("landmark_markers", 1, true);
  trajectory_ = node_.advertise<nav_msgs::Path>("trajectory", 1, true);
  corrected_trajectory_ = node_.advertise<nav_msgs::Path>("corrected_trajectory", 1, true);
  lost_ = node_.advertise<std_msgs::Bool>("lost", 1, true);
  ros::NodeHandle private_node("~");
  services_ = {
      node_.advertiseService("global_localization", &FastSlamNode::onGlobalLocalization, this),
      private_node.advertiseService("reset", &FastSlamNode::onReset, this),
      private_node.advertiseService("pause", &FastSlamNode::onPause, this)};
}

void FastSlamNode::subscribe() {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  for (const std::string& topic : node_parameters_.feature_topics) {
    subscribers_.push_back(node_.subscribe(topic, 20, &FastSlamNode::onFeatures, this, hints));
  }
  subscribers_.push_back(
      node_.subscribe("initialpose", 2, &FastSlamNode::onInitialPose, this, hints));
  subscribers_.push_back(
      node_.subscribe("smoothed_trajectory", 1, &FastSlamNode::onSmoothedTrajectory, this, hints));
  if (node_parameters_.use_scan) {
    subscribers_.push_back(node_.subscribe("scan", 20, &FastSlamNode::onScan, this, hints));
  }
  for (const ros::Subscriber& subscriber : subscribers_)
    ROS_INFO_STREAM("Listening to " << subscriber.getTopic());
}

void FastSlamNode::onFeatures(const ram_slam_msgs::FeatureList& message) {
  try {
    CheckedFeatures checked = toFeatureList(message, node_parameters_.frames.base);
    diagnostics_.addFeatures(checked.list.features.size(), checked.rejected_count);
    if (checked.rejected_count > 0) {
      ROS_WARN_STREAM_THROTTLE(
          kLogPeriodS, "Left out " << checked.rejected_count << " features that are no good");
    }
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    if (queue_.size() >= kMostQueued) {
      queue_.pop_front();
      ROS_WARN_THROTTLE(kLogPeriodS,
                        "Features come faster than they can be used: dropped the oldest");
    }
    enqueue(std::move(checked.list));
    queue_changed_.notify_one();
  } catch (const std::exception& error) {
    diagnostics_.addRejectedList();
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Rejected features: " << error.what());
  }
}

void FastSlamNode::enqueue(ram_slam::FeatureList list) {
  // Detectors need different times for one scan; what is much older is of another run of the clock.
  auto place = queue_.end();
  while (place != queue_.begin() && std::prev(place)->stamp_ns > list.stamp_ns &&
         std::prev(place)->stamp_ns - list.stamp_ns < kClockSetBackNs)
    --place;
  queue_.insert(place, std::move(list));
}

void FastSlamNode::onScan(const sensor_msgs::LaserScanConstPtr& message) {
  views_.add(message);
}

void FastSlamNode::onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message) {
  try {
    if (message.header.frame_id != node_parameters_.frames.map) {
      throw std::invalid_argument("it is in '" + message.header.frame_id + "' instead of '" +
                                  node_parameters_.frames.map + "'");
    }
    ram_slam::PoseWithCovariance2 pose = toPoseWithCovariance2(message.pose);
    const Eigen::Vector3d least(kInitialSigma_m, kInitialSigma_m, kInitialSigma_rad);
    for (int i = 0; i < 3; ++i)
      pose.covariance(i, i) = std::max(pose.covariance(i, i), least[i] * least[i]);
    const std::unique_lock<std::timed_mutex> lock(filter_mutex_, kServicePatience);
    if (!lock.owns_lock()) throw std::runtime_error("the filter is busy");
    filter_->setPose(pose);
    map_to_odom_.correct(filter_->stamp_ns(), pose.pose);
    publishLost();
    ROS_INFO_STREAM("Pose set to (" << pose.pose.x_m << " m, " << pose.pose.y_m << " m, "
                                    << pose.pose.yaw_rad << " rad)");
  } catch (const std::exception& error) {
    ROS_WARN_STREAM("Rejected an initial pose: " << error.what());
  }
}

void FastSlamNode::onSmoothedTrajectory(const nav_msgs::Path& message) {
  try {
    ram_slam::Trajectory trajectory = toTrajectory(message);
    const std::unique_lock<std::timed_mutex> lock(filter_mutex_, kServicePatience);
    if (!lock.owns_lock()) throw std::runtime_error("the filter is busy");
    const ram_slam::Pose2 before = filter_->estimate().pose;
    const ram_slam::Pose2 map_from_smoothed = filter_->followTrajectory(trajectory);
    tellOfCorrection(before, filter_->estimate().pose);
    for (ram_slam::StampedPose2& stamped : trajectory)
      stamped.pose = map_from_smoothed * stamped.pose;
    corrected_trajectory_.publish(toPath(trajectory, node_parameters_.frames.map));
    last_output_ns_ = 0;
    publishPose();
    publishMap();
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Rejected a smoothed trajectory: " << error.what());
  }
}

bool FastSlamNode::onGlobalLocalization(std_srvs::Empty::Request& /*request*/,
                                        std_srvs::Empty::Response& /*response*/) {
  const std::unique_lock<std::timed_mutex> lock(filter_mutex_, kServicePatience);
  if (!lock.owns_lock()) {
    ROS_WARN("No global localization: the filter is busy");
    return false;
  }
  filter_->forgetPose();
  if (!filter_->lost()) {
    ROS_WARN("No global localization: there is no map yet, or relocalisation is disabled");
    return false;
  }
  publishLost();
  return true;
}

bool FastSlamNode::onReset(std_srvs::Trigger::Request& /*request*/,
                           std_srvs::Trigger::Response& response) {
  const std::unique_lock<std::timed_mutex> lock(filter_mutex_, kServicePatience);
  response.success = lock.owns_lock();
  if (response.success) {
    restart("asked to");
    publishLost();
  } else {
    response.message = "the filter is busy; try again";
  }
  return true;
}

bool FastSlamNode::onPause(std_srvs::SetBool::Request& request,
                           std_srvs::SetBool::Response& response) {
  paused_ = request.data;
  response.success = true;
  response.message =
      request.data ? "features are dropped until further notice" : "features are used";
  ROS_INFO_STREAM((request.data ? "Paused" : "Resumed"));
  return true;
}

void FastSlamNode::run() {
  while (true) {
    ram_slam::FeatureList list;
    {
      std::unique_lock<std::mutex> lock(queue_mutex_);
      queue_changed_.wait(lock, [this] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      list = std::move(queue_.front());
      queue_.pop_front();
    }
    if (!paused_) process(list);
  }
}

void FastSlamNode::process(const ram_slam::FeatureList& list) {
  const auto start = steady_clock::now();
  auto pause = kFirstRetry;
  const auto patience = interrupted_ ? kPatienceInterrupted : kPatience;
  try {
    while (!tryUpdate(list)) {
      if (stop_ || !ros::ok()) return;
      if (steady_clock::now() - start > patience) {
        ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "No motion up to the features: " << missing_motion_);
        interrupted_ = true;
        bridgeGap(list.stamp_ns);
        return;
      }
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, kLongestRetry);
    }
    if (interrupted_) ROS_INFO("Odometry is back");
    interrupted_ = false;
    motion_.forget();
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Skipped features: " << error.what());
  }
}

bool FastSlamNode::tryUpdate(const ram_slam::FeatureList& list) {
  const std::shared_ptr<const ram_slam::LaserView> view = views_.at(list.stamp_ns);
  const std::lock_guard<std::timed_mutex> lock(filter_mutex_);
  if (list.stamp_ns + kClockSetBackNs < filter_->stamp_ns()) restart("the clock was set back");
  try {
    // The first list does not need a motion, but the second one needs it from here on.
    if (!filter_->started()) kinematics_.motion(list.stamp_ns, list.stamp_ns);
    filter_->update(list, motion_, view);
  } catch (const std::out_of_range& error) {
    missing_motion_ = error.what();
    return false;
  }
  from_checkpoint_ = false;
  publishPose();
  publishMap();
  publishLost();
  if (checkpoints_.isDue(filter_->stamp_ns())) checkpoints_.keep(filter_->checkpoint());
  return true;
}

void FastSlamNode::restart(const std::string& reason) {
  ROS_WARN_STREAM("Starting over with an empty map: " << reason);
  if (from_checkpoint_) {
    checkpoints_.putAside("it is of another run of the clock");
  } else {
    checkpoints_.remove();
  }
  from_checkpoint_ = false;
  filter_ = makeFilter();
  map_to_odom_.reset();
  motion_.forget();
  interrupted_ = false;
  last_output_ns_ = 0;
}

std::unique_ptr<ram_slam::Tracker> FastSlamNode::makeFilter() const {
  return std::make_unique<ram_slam::Tracker>(parameters_, recovery_parameters_,
                                             matchers_.matchers());
}

bool FastSlamNode::goOnFromCheckpoint() {
  const std::optional<ram_slam::Checkpoint> checkpoint = checkpoints_.load();
  if (!checkpoint) return false;
  try {
    filter_->restore(*checkpoint);
  } catch (const std::exception& error) {
    checkpoints_.putAside(error.what());
    return false;
  }
  from_checkpoint_ = true;
  ROS_WARN_STREAM("Going on from the checkpoint of "
                  << toTime(checkpoint->map.stamp_ns) << " in " << node_parameters_.checkpoint_file
                  << ", with " << checkpoint->map.landmarks.size() << " landmarks");
  publishMap();
  return true;
}

void FastSlamNode::bridgeGap(std::int64_t stamp_ns) {
  const std::lock_guard<std::timed_mutex> lock(filter_mutex_);
  const std::optional<ram_slam::Pose2> moved =
      map_to_odom_.odometryBetween(filter_->stamp_ns(), stamp_ns);
  motion_.interruptedUntil(stamp_ns, moved);
  if (!from_checkpoint_ || moved) return;
  ROS_WARN("No odometry since the checkpoint: looking for the robot in its map");
  from_checkpoint_ = false;
  filter_->forgetPose();
  publishLost();
}

void FastSlamNode::loadInitialMap() {
  const std::string& path = node_parameters_.initial_map;
  if (path.empty()) return;
  const ram_slam::WorldMap world =
      ram_slam::worldMapFromBytes(ram_slam::readWholeFile(path, kMostMapBytes));
  const ram_slam::LandmarkMap map = toLandmarkMap(world.landmarks());
  filter_->setMap(map);
  ROS_INFO_STREAM("Loaded " << map.landmarks.size() << " landmarks from " << path
                            << "; looking for the robot among them");
}

void FastSlamNode::publishPose() {
  geometry_msgs::PoseWithCovarianceStamped pose;
  pose.header.stamp = toTime(filter_->stamp_ns());
  pose.header.frame_id = node_parameters_.frames.map;
  pose.pose = toPoseWithCovarianceMessage(filter_->estimate());
  map_to_odom_.correct(filter_->stamp_ns(), filter_->estimate().pose);
  pose_.publish(pose);
  if (particles_.getNumSubscribers() == 0) return;
  geometry_msgs::PoseArray particles;
  particles.header = pose.header;
  if (!filter_->lost())
    for (const ram_slam::Particle& particle : filter_->filter().particles()) {
      particles.poses.push_back(toPoseMessage(particle.proposal.pose));
    }
  particles_.publish(particles);
}

void FastSlamNode::publishLost() {
  diagnostics_.set(*filter_, paused_);
  if (published_lost_ == filter_->lost()) return;
  if (filter_->lost()) {
    ROS_WARN_STREAM("Lost: " << toText(filter_->reason())
                             << "; the map stays as it is until the robot is found");
  } else if (published_lost_) {
    ROS_INFO_STREAM("The robot is found");
  }
  published_lost_ = filter_->lost();
  std_msgs::Bool message;
  message.data = filter_->lost();
  lost_.publish(message);
}

void FastSlamNode::publishMap() {
  const auto period_ns = static_cast<std::int64_t>(node_parameters_.output_period * 1e9);
  if (last_output_ns_ != 0 && filter_->stamp_ns() < last_output_ns_ + period_ns) return;
  last_output_ns_ = filter_->stamp_ns();
  const ram_slam::LandmarkMap map = filter_->filter().landmarks();
  landmarks_.publish(toLandmarkMapMessage(map, node_parameters_.frames.map));
  landmark_markers_.publish(toMarkers(map, node_parameters_.frames.map));
  trajectory_.publish(toPath(filter_->filter().trajectory(), node_parameters_.frames.map));
}

}  // namespace ram_slam_ros
