// SPDX-License-Identifier: BSD-3-Clause
#include "fast_slam_node.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>

#include <geometry_msgs/PoseArray.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/Tracking.h>
#include <std_msgs/Bool.h>

#include "ram_parameters/ros/run_node.hpp"
#include "ram_slam/io/atomic_file.hpp"
#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/landmark_conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"
#include "ram_slam/stages/clock_guard.hpp"
#include "ram_slam/world_map/landmark_layer.hpp"
#include "ram_slam/world_map/map_folder.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
namespace {

using Seconds = std::chrono::duration<double>;
using std::chrono::steady_clock;

ram_slam::EstimatorFactory readEstimator(ram_parameters::ParameterReader& reader,
                                         const std::string& name,
                                         const MatcherPlugins& matchers) {
  return ram_slam::findEstimator(name)(reader, matchers.matchers());
}

/// The estimators of a node that begins with a map made before, if it does.
ram_slam::EstimatorFactory startingInInitialMap(
    ram_slam::EstimatorFactory make, const ram_slam::FastSlamNodeParameters& parameters) {
  if (parameters.initial_map.empty()) return make;
  const ram_slam::WorldMap world =
      ram_slam::loadWorldMap(ram_slam::expandHome(parameters.initial_map));
  const ram_slam::LandmarkMap map = toLandmarkMap(world.landmarks());
  ROS_INFO_STREAM("Loaded " << map.landmarks.size() << " landmarks and " << world.scans().size()
                            << " scans from " << parameters.initial_map
                            << "; searching for the robot among them");
  return ram_slam::startingIn(std::move(make), map, ram_slam::viewsOf(world.scans()),
                              parameters.localise_only);
}

double readFutureInterpol(ram_parameters::ParameterReader& reader) {
  double ahead_s = 0.1;
  reader.read("future_interpol", ahead_s);
  return ahead_s;
}

}  // namespace

FastSlamNode::FastSlamNode(ram_parameters::ParameterReader& reader)
    : node_parameters_(ram_slam::readFastSlamNodeParameters(reader)),
      future_interpol_s_(readFutureInterpol(reader)),
      make_estimator_(startingInInitialMap(
          readEstimator(reader, node_parameters_.estimator, matchers_), node_parameters_)),
      views_(node_parameters_.frames.base,
             buffer_,
             static_cast<std::size_t>(node_parameters_.waiting.queue_size)),
      map_to_odom_(
          node_parameters_.frames, node_parameters_.map_to_odom, future_interpol_s_, buffer_),
      kinematics_(node_),
      checkpoints_(node_parameters_.checkpoint_file, node_parameters_.checkpoint_period),
      stage_(make_estimator_, kinematics_, node_parameters_.readings),
      diagnostics_(ram_slam::Link::kPose, "localisation", [this] { return report(); }) {
  advertise();
  if (!restoreCheckpoint()) publishMap();
  publishLost();
  thread_ = std::thread([this] { run(); });
  subscribe();
}

FastSlamNode::~FastSlamNode() {
  subscribers_.clear();
  stop_ = true;
  queue_changed_.notify_all();
  thread_.join();
  // Ctrl-C ends the launch; after rosnode kill or a lost master roslaunch starts the node again.
  if (ram_parameters_ros::wasInterrupted()) checkpoints_.remove();
}

void FastSlamNode::advertise() {
  pose_ = node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 10);
  amcl_pose_ = node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("amcl_pose", 2);
  particles_ = node_.advertise<geometry_msgs::PoseArray>("particlecloud", 2);
  landmarks_ = node_.advertise<ram_slam_msgs::LandmarkMap>("landmarks", 1, kLatched);
  landmark_markers_ =
      node_.advertise<visualization_msgs::MarkerArray>("landmark_markers", 1, kLatched);
  trajectory_ = node_.advertise<nav_msgs::Path>("trajectory", 1, kLatched);
  corrected_trajectory_ = node_.advertise<nav_msgs::Path>("corrected_trajectory", 1, kLatched);
  lost_ = node_.advertise<std_msgs::Bool>("lost", 1, kLatched);
  tracking_ = node_.advertise<ram_slam_msgs::Tracking>("tracking", 10, kLatched);
  ros::NodeHandle private_node("~");
  services_ = {
      node_.advertiseService("global_localization", &FastSlamNode::onGlobalLocalization, this),
      private_node.advertiseService("reset", &FastSlamNode::onReset, this),
      private_node.advertiseService("pause", &FastSlamNode::onPause, this)};
}

void FastSlamNode::subscribe() {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  const std::vector<std::string>& topics = node_parameters_.feature_topics;
  for (const std::string& topic : topics) subscribeFeatures(topic, topics.size() == 1);
  diagnostics_.need(buffer_,
                    {node_parameters_.frames.odom, "odom_frame", node_parameters_.frames.base,
                     "base_frame", "the node that publishes the odometry must also publish it"});
  diagnostics_.setOutput(pose_.getTopic());
  subscribers_.push_back(
      node_.subscribe("initialpose", 2, &FastSlamNode::onInitialPose, this, hints));
  subscribers_.push_back(
      node_.subscribe("smoothed_trajectory", 1, &FastSlamNode::onSmoothedTrajectory, this, hints));
  subscribers_.push_back(node_.subscribe("/tf", 100, &FastSlamNode::onTransforms, this, hints));
  subscribers_.push_back(node_.subscribe("map_pose", 100, &FastSlamNode::onMapPose, this, hints));
  if (node_parameters_.use_scan) {
    subscribers_.push_back(node_.subscribe("scan", 20, &FastSlamNode::onScan, this, hints));
  }
  for (const ros::Subscriber& subscriber : subscribers_)
    ROS_INFO_STREAM("Subscribed to " << subscriber.getTopic());
}

void FastSlamNode::subscribeFeatures(const std::string& topic, bool is_needed) {
  // The callback comes with the input, which is known once the topic is subscribed.
  const auto input = std::make_shared<NodeDiagnostics::Input*>(nullptr);
  const boost::function<void(const ros::MessageEvent<const ram_slam_msgs::FeatureList>&)> callback =
      [this, input](const auto& event) { onFeatures(**input, event); };
  subscribers_.push_back(node_.subscribe<ram_slam_msgs::FeatureList>(
      topic, 20, callback, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  ram_slam::InputFacts facts = featuresInput();
  facts.argument = topic;
  facts.is_needed = is_needed;
  *input = &diagnostics_.watch<ram_slam_msgs::FeatureList>(subscribers_.back(), facts);
}

void FastSlamNode::onFeatures(NodeDiagnostics::Input& input,
                              const ros::MessageEvent<const ram_slam_msgs::FeatureList>& event) {
  diagnostics_.arrived(input, event);
  const ram_slam_msgs::FeatureList& message = *event.getMessage();
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    messages_.add(event.getPublisherName(), message.header.seq);
  }
  try {
    CheckedFeatures checked = toFeatureList(message, node_parameters_.frames.base);
    health_.addFeatures(checked.list.features.size(), checked.rejected_count);
    if (checked.rejected_count > 0) {
      ROS_WARN_STREAM_THROTTLE(
          kLogPeriodS, checked.rejected_count << " of " << message.features.size()
                                              << " features on " << subscribers_.front().getTopic()
                                              << " rejected: position or covariance unusable");
    }
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    auto passed =
        guard_.add(checked.list.stamp_ns, checked.list, queue_drops_, event.getPublisherName());
    for (ram_slam::FeatureList& list : passed.messages) enqueue(std::move(list));
    queue_changed_.notify_one();
  } catch (const std::exception& error) {
    health_.addRejectedList();
    diagnostics_.refused(input, error.what());
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Rejected features: " << error.what());
  }
}

void FastSlamNode::enqueue(ram_slam::FeatureList list) {
  if (queue_.size() >= static_cast<std::size_t>(node_parameters_.waiting.queue_size)) {
    queue_drops_.add(ram_slam::DropReason::kQueueFull, queue_.front().stamp_ns, "features");
    queue_.pop_front();
  }
  // Detectors need different times for one scan; what is much older is of another run of the clock.
  auto place = queue_.end();
  while (place != queue_.begin() && std::prev(place)->stamp_ns > list.stamp_ns &&
         !ram_slam::ClockGuard::isSetBack(std::prev(place)->stamp_ns, list.stamp_ns))
    --place;
  queue_.insert(place, std::move(list));
}

void FastSlamNode::onScan(const sensor_msgs::LaserScanConstPtr& message) {
  views_.add(message);
}

void FastSlamNode::onTransforms(const ros::MessageEvent<const tf2_msgs::TFMessage>& event) {
  const ram_slam::Frames& frames = node_parameters_.frames;
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  for (const geometry_msgs::TransformStamped& transform : event.getMessage()->transforms) {
    const std::string& child = transform.child_frame_id;
    if (child != frames.odom && child != frames.base) continue;
    authorities_.add(transform.header.frame_id, child, event.getPublisherName(),
                     ros::WallTime::now().toSec());
  }
}

void FastSlamNode::onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message) {
  try {
    if (message.header.frame_id != node_parameters_.frames.map) {
      throw std::invalid_argument("it is in '" + message.header.frame_id + "' instead of '" +
                                  node_parameters_.frames.map + "'");
    }
    ram_slam::PoseWithCovariance2 pose = toPoseWithCovariance2(message.pose);
    const Eigen::Vector3d least(node_parameters_.initial_sigma_m, node_parameters_.initial_sigma_m,
                                node_parameters_.initial_sigma_rad);
    for (int i = 0; i < 3; ++i)
      pose.covariance(i, i) = std::max(pose.covariance(i, i), least[i] * least[i]);
    const std::unique_lock<std::timed_mutex> lock(stage_mutex_,
                                                  Seconds(node_parameters_.waiting.service_s));
    if (!lock.owns_lock()) throw std::runtime_error("the estimator is busy");
    stage_.estimator().setPose(pose);
    map_to_odom_.correct(stage_.estimator().stamp_ns(), pose.pose);
    publishLost();
    ROS_INFO_STREAM("Pose set to (" << pose.pose.x_m << " m, " << pose.pose.y_m << " m, "
                                    << pose.pose.yaw_rad << " rad)");
  } catch (const std::exception& error) {
    ROS_WARN_STREAM("Rejected an initial pose: " << error.what());
  }
}

bool FastSlamNode::onGlobalLocalization(std_srvs::Empty::Request& /*request*/,
                                        std_srvs::Empty::Response& /*response*/) {
  const std::unique_lock<std::timed_mutex> lock(stage_mutex_,
                                                Seconds(node_parameters_.waiting.service_s));
  if (!lock.owns_lock()) {
    ROS_WARN("No global localization: the estimator is busy");
    return false;
  }
  stage_.estimator().forgetPose();
  if (!stage_.estimator().isLost()) {
    ROS_WARN("No global localization: there is no map yet, or relocalisation is disabled");
    return false;
  }
  publishLost();
  return true;
}

bool FastSlamNode::onReset(std_srvs::Trigger::Request& /*request*/,
                           std_srvs::Trigger::Response& response) {
  const std::unique_lock<std::timed_mutex> lock(stage_mutex_,
                                                Seconds(node_parameters_.waiting.service_s));
  response.success = lock.owns_lock();
  if (response.success) {
    stage_.reset();
    {
      const std::lock_guard<std::mutex> queue_lock(queue_mutex_);
      guard_ = {};
    }
    afterReset("a reset was requested");
    publishLost();
  } else {
    response.message = "the estimator is busy; try again";
  }
  return true;
}

bool FastSlamNode::onPause(std_srvs::SetBool::Request& request,
                           std_srvs::SetBool::Response& response) {
  paused_ = request.data;
  response.success = true;
  response.message = request.data ? "features are dropped until resumed" : "features are used";
  ROS_INFO_STREAM((request.data ? "Paused" : "Resumed"));
  return true;
}

void FastSlamNode::run() {
  while (true) {
    std::optional<ram_slam::FeatureList> list;
    {
      std::unique_lock<std::mutex> lock(queue_mutex_);
      queue_changed_.wait(lock, [this] { return stop_ || !queue_.empty() || smoothed_; });
      if (stop_) return;
      if (!queue_.empty()) {
        list = std::move(queue_.front());
        queue_.pop_front();
      }
    }
    if (list && paused_) {
      const std::lock_guard<std::timed_mutex> lock(stage_mutex_);
      stage_.drops().add(ram_slam::DropReason::kPaused, list->stamp_ns, "features");
    } else if (list) {
      process(*list);
    } else {
      const std::lock_guard<std::timed_mutex> lock(stage_mutex_);
      followCorrection();
      if (last_output_ns_ == 0 && stage_.estimator().started()) {
        publishPose();
        publishMap();
      }
    }
  }
}

void FastSlamNode::process(const ram_slam::FeatureList& list) {
  const auto start = steady_clock::now();
  const ram_slam::WaitingParameters& waiting = node_parameters_.waiting;
  const Seconds patience(interrupted_ ? waiting.interrupted_s : waiting.motion_s);
  double pause_s = waiting.first_retry_s;
  while (!tryUpdate(list)) {
    if (stop_ || !ros::ok()) return;
    if (steady_clock::now() - start > patience) {
      interrupted_ = true;
      bridgeGap(list.stamp_ns);
      return;
    }
    std::this_thread::sleep_for(Seconds(pause_s));
    pause_s = std::min(2.0 * pause_s, waiting.longest_retry_s);
  }
  if (interrupted_) ROS_INFO("The motion up to the features is known again");
  interrupted_ = false;
}

bool FastSlamNode::tryUpdate(const ram_slam::FeatureList& list) {
  const std::shared_ptr<const ram_slam::LaserView> view = views_.at(list.stamp_ns);
  const std::lock_guard<std::timed_mutex> lock(stage_mutex_);
  const int reset_count = stage_.resetCount();
  followMapPoses();
  const auto motion = stage_.motionUntil(list.stamp_ns);
  if (stage_.resetCount() != reset_count) afterReset("the stamps of the features were set back");
  if (!motion) return false;
  if (stage_.isDue(*motion) && stage_.update(list, *motion, view)) from_checkpoint_ = false;
  followCorrection();
  const ram_slam::Estimator& estimator = stage_.estimator();
  if (estimator.started()) {
    publishPose(std::max(list.stamp_ns, estimator.stamp_ns()), stage_.poseAt(*motion));
    publishMap();
  }
  publishLost();
  if (checkpoints_.isDue(estimator.stamp_ns())) checkpoints_.keep(estimator.checkpoint());
  return true;
}

void FastSlamNode::afterReset(const std::string& reason) {
  ROS_WARN_STREAM("Starting again: " << reason);
  if (from_checkpoint_) {
    checkpoints_.putAside("it is of another run of the clock");
  } else {
    checkpoints_.remove();
  }
  from_checkpoint_ = false;
  map_to_odom_.reset();
  interrupted_ = false;
  last_output_ns_ = 0;
}

bool FastSlamNode::restoreCheckpoint() {
  const std::optional<ram_slam::Checkpoint> checkpoint = checkpoints_.load();
  if (!checkpoint) return false;
  try {
    stage_.estimator().restore(*checkpoint);
  } catch (const std::exception& error) {
    checkpoints_.putAside(error.what());
    return false;
  }
  from_checkpoint_ = true;
  ROS_WARN_STREAM("Continuing from the checkpoint of "
                  << toTime(checkpoint->map.stamp_ns) << " in " << node_parameters_.checkpoint_file
                  << ", with " << checkpoint->map.landmarks.size() << " landmarks");
  publishMap();
  return true;
}

void FastSlamNode::bridgeGap(std::int64_t stamp_ns) {
  const std::lock_guard<std::timed_mutex> lock(stage_mutex_);
  const std::optional<ram_slam::Pose2> moved =
      map_to_odom_.odometryBetween(stage_.estimator().stamp_ns(), stamp_ns);
  stage_.bridgeGap(stamp_ns, moved);
  publishLost();
  if (!from_checkpoint_ || moved) return;
  ROS_WARN("No odometry since the checkpoint: searching for the robot in its map");
  from_checkpoint_ = false;
  stage_.estimator().forgetPose();
  publishLost();
}

}  // namespace ram_slam_ros
