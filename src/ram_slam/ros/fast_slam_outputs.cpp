// SPDX-License-Identifier: BSD-3-Clause
// What the node publishes.
#include <geometry_msgs/PoseArray.h>
#include <nav_msgs/Path.h>
#include <ram_slam_msgs/Tracking.h>
#include <std_msgs/Bool.h>

#include "ram_slam/ros/conversions.hpp"
#include "ram_slam/ros/landmark_conversions.hpp"
#include "ram_slam/ros/occupancy_conversions.hpp"

#include "fast_slam_node.hpp"
#include "node_defaults.hpp"

namespace ram_slam_ros {

void FastSlamNode::publishPose() {
  publishPose(stage_.estimator().stamp_ns(), stage_.estimator().estimate().pose);
}

void FastSlamNode::publishPose(std::int64_t stamp_ns, const ram_slam::Pose2& map_from_base) {
  ram_slam::PoseWithCovariance2 estimate = stage_.estimator().estimate();
  estimate.pose = map_from_base;
  geometry_msgs::PoseWithCovarianceStamped pose;
  pose.header.stamp = toTime(stamp_ns);
  pose.header.frame_id = node_parameters_.frames.map;
  pose.pose = toPoseWithCovarianceMessage(estimate);
  map_to_odom_.correct(stamp_ns, map_from_base);
  pose_.publish(pose);
  diagnostics_.answered(stamp_ns);
  amcl_pose_.publish(pose);
  if (particles_.getNumSubscribers() == 0) return;
  geometry_msgs::PoseArray particles;
  particles.header = pose.header;
  for (const ram_slam::Pose2& hypothesis : stage_.estimator().hypotheses())
    particles.poses.push_back(toPoseMessage(hypothesis));
  particles_.publish(particles);
}

void FastSlamNode::publishLost() {
  const ram_slam::Estimator& estimator = stage_.estimator();
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    drop_log_.log(stage_.drops(),
                  subscribers_.empty() ? "features" : subscribers_.front().getTopic());
    queue_log_.log(queue_drops_,
                   subscribers_.empty() ? "features" : subscribers_.front().getTopic());
  }
  health_.set(stage_);
  const std::optional<ram_slam::Tracking> change = stage_.takeTrackingChange();
  if (!change) return;
  if (change->is_lost) {
    ROS_WARN_STREAM("Lost: " << estimator.state()
                             << "; the map stays as it is until the robot is found");
  } else {
    ROS_INFO_STREAM("The robot's place is known");
  }
  std_msgs::Bool lost;
  lost.data = change->is_lost;
  lost_.publish(lost);
  ram_slam_msgs::Tracking tracking;
  tracking.header.frame_id = node_parameters_.frames.map;
  tracking.header.stamp = toTime(change->stamp_ns);
  tracking.lost = change->is_lost;
  tracking.certain_until = toTime(change->certain_until_ns);
  tracking.pose = toPoseMessage(change->map_from_base);
  tracking_.publish(tracking);
}

NodeDiagnostics::Report FastSlamNode::report() {
  NodeDiagnostics::Report report = health_.report();
  const auto add = [&](ram_slam::Link link, ram_slam::Severity severity, const char* name,
                       const std::string& text) {
    if (!text.empty()) report.causes.push_back({link, severity, name, text});
  };
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  report.drops.add(queue_drops_);
  report.messages = messages_;
  add(ram_slam::Link::kTf, ram_slam::Severity::kError, "two publishers",
      authorities_.conflict(ros::WallTime::now().toSec()));
  add(ram_slam::Link::kKinematics, ram_slam::Severity::kError, "no kinematics",
      kinematics_.problem());
  add(ram_slam::Link::kPose, ram_slam::Severity::kWarning, "no checkpoint", checkpoints_.problem());
  if (!paused_) return report;
  report.causes = {{ram_slam::Link::kPose, ram_slam::Severity::kWarning, "paused",
                    "paused: features are dropped until the service ~pause is called with false"}};
  return report;
}

void FastSlamNode::publishMap() {
  const auto period_ns = static_cast<std::int64_t>(node_parameters_.output_period * 1e9);
  if (last_output_ns_ != 0 && stage_.estimator().stamp_ns() < last_output_ns_ + period_ns) return;
  last_output_ns_ = stage_.estimator().stamp_ns();
  const ram_slam::LandmarkMap map = stage_.estimator().landmarks();
  landmarks_.publish(toLandmarkMapMessage(map, node_parameters_.frames.map));
  landmark_markers_.publish(toMarkers(map, node_parameters_.frames.map, node_parameters_.markers));
  const auto most = static_cast<std::size_t>(node_parameters_.max_published_poses);
  trajectory_.publish(toPath(ram_slam::withAtMost(stage_.estimator().trajectory(), most),
                             node_parameters_.frames.map));
}

}  // namespace ram_slam_ros
