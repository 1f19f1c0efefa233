// SPDX-License-Identifier: BSD-3-Clause
#include "landmark_smoother_node.hpp"

#include <exception>
#include <stdexcept>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/landmark_conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "node_defaults.hpp"

namespace ram_slam_ros {
LandmarkSmootherNode::LandmarkSmootherNode(ram_parameters::ParameterReader& reader)
    : kinematics_(node_),
      diagnostics_(ram_slam::Link::kPose, "smoothing", [this] { return report(); }) {
  parameters_ = ram_slam::readLandmarkSmootherParameters(reader);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  smoothed_trajectory_ = node_.advertise<nav_msgs::Path>("smoothed_trajectory", 1, kLatched);
  smoothed_landmarks_ =
      node_.advertise<ram_slam_msgs::LandmarkMap>("smoothed_landmarks", 1, kLatched);
  subscribers_ = {
      node_.subscribe("features", kQueueSize, &LandmarkSmootherNode::onFeatures, this, hints),
      node_.subscribe("trajectory", 1, &LandmarkSmootherNode::onTrajectory, this),
      node_.subscribe("landmarks", 1, &LandmarkSmootherNode::onLandmarks, this)};
  smooth_service_ = private_node_.advertiseService("smooth", &LandmarkSmootherNode::onSmooth, this);
  features_input_ =
      &diagnostics_.watch<ram_slam_msgs::FeatureList>(subscribers_.front(), featuresInput());
  for (const ros::Subscriber& subscriber : subscribers_)
    ROS_INFO_STREAM("Subscribed to " << subscriber.getTopic());
}

NodeDiagnostics::Report LandmarkSmootherNode::report() const {
  NodeDiagnostics::Report report;
  report.drops = drops_;
  report.values = {{"lists that can be smoothed", static_cast<double>(steps_.size())}};
  const std::string problem = kinematics_.problem();
  if (!problem.empty()) {
    report.causes.push_back(
        {ram_slam::Link::kKinematics, ram_slam::Severity::kError, "no kinematics", problem});
  }
  return report;
}

void LandmarkSmootherNode::onFeatures(
    const ros::MessageEvent<const ram_slam_msgs::FeatureList>& event) {
  diagnostics_.arrived(*features_input_, event);
  try {
    const ram_slam::FeatureList checked =
        toFeatureList(*event.getMessage(), parameters_.base_frame).list;
    auto passed = guard_.add(checked.stamp_ns, checked, drops_);
    if (passed.is_set_back) restart();
    for (ram_slam::FeatureList& list : passed.messages) {
      const std::int64_t newest_ns = !waiting_.empty() ? waiting_.back().stamp_ns
                                     : !steps_.empty() ? steps_.back().list.stamp_ns
                                                       : list.stamp_ns;
      if (list.stamp_ns < newest_ns)
        throw std::invalid_argument("they are older than those before");
      waiting_.push_back(std::move(list));
    }
  } catch (const std::exception& error) {
    diagnostics_.refused(*features_input_, error.what());
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Rejected features: " << error.what());
  }
  drop_log_.log(drops_, subscribers_.front().getTopic());
  settle();
}

void LandmarkSmootherNode::restart() {
  ROS_WARN("The stamps of the features were set back: smoothing starts again");
  steps_.clear();
  waiting_.clear();
  trajectory_.clear();
  landmarks_.clear();
}

void LandmarkSmootherNode::settle() {
  while (!waiting_.empty()) {
    const std::int64_t stamp_ns = waiting_.front().stamp_ns;
    ram_slam::FeatureStep step;
    try {
      if (!steps_.empty()) step.motion = kinematics_.motion(steps_.back().list.stamp_ns, stamp_ns);
    } catch (const std::exception& error) {
      const auto patience_ns = static_cast<std::int64_t>(1e9 * parameters_.motion_patience_s);
      if (waiting_.back().stamp_ns < stamp_ns + patience_ns) return;
      ROS_WARN_STREAM_THROTTLE(kLogPeriodS,
                               "Features dropped, no motion up to them: " << error.what());
      waiting_.pop_front();
      continue;
    }
    const std::int64_t interval_ns = steps_.empty() ? 0 : stamp_ns - steps_.back().list.stamp_ns;
    step.list = deskew(std::move(waiting_.front()), step.motion.pose, interval_ns);
    waiting_.pop_front();
    steps_.push_back(std::move(step));
  }
}

void LandmarkSmootherNode::onTrajectory(const nav_msgs::Path& message) {
  try {
    trajectory_ = toTrajectory(message);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Rejected a trajectory: " << error.what());
  }
}

void LandmarkSmootherNode::onLandmarks(const ram_slam_msgs::LandmarkMap& message) {
  try {
    landmarks_ = toLandmarkEstimates(message, parameters_.map_frame);
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(kLogPeriodS, "Rejected landmarks: " << error.what());
  }
}

std::vector<ram_slam::FeatureStep> LandmarkSmootherNode::covered() const {
  std::vector<ram_slam::FeatureStep> result;
  for (const ram_slam::FeatureStep& step : steps_) {
    if (poseAt(trajectory_, step.list.stamp_ns)) result.push_back(step);
  }
  return result;
}

bool LandmarkSmootherNode::onSmooth(std_srvs::Trigger::Request& /*request*/,
                                    std_srvs::Trigger::Response& response) {
  try {
    settle();
    const std::vector<ram_slam::FeatureStep> steps = covered();
    if (steps.empty()) throw std::runtime_error("no features along a trajectory yet");
    const ram_slam::SmoothedLandmarks smoothed =
        ram_slam::smoothLandmarks(steps, trajectory_, landmarks_, parameters_);
    smoothed_trajectory_.publish(toPath(smoothed.trajectory, parameters_.map_frame));
    smoothed_landmarks_.publish(toLandmarkMapMessage(smoothed.map, parameters_.map_frame));
    response.success = true;
    response.message = std::to_string(smoothed.map.landmarks.size()) + " landmarks from " +
                       std::to_string(steps.size()) + " lists";
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

}  // namespace ram_slam_ros
