// SPDX-License-Identifier: BSD-3-Clause
#include "bag_recording.hpp"

#include <set>
#include <stdexcept>

#include <ram_slam/ros/conversions.hpp>
#include <ram_slam/ros/mounting.hpp>

namespace ramscout_bringup_ros {
namespace {

using ram_slam_ros::toNanoseconds;

constexpr std::int64_t kReorderingWindowNs = 1000000000;
constexpr int kOdometryFirst = 0;
constexpr int kScanSecond = 1;

std::string withoutSlash(const std::string& name) {
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}

/// Topics of one message type, each once, in alphabetical order.
std::vector<std::string> topicsOf(rosbag::View& view, const std::string& type) {
  std::set<std::string> topics;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    if (connection->datatype == type) topics.insert(connection->topic);
  }
  return {topics.begin(), topics.end()};
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none" : list;
}

/// The topic whose last part is `name`, else the only one there is.
std::string choose(const std::vector<std::string>& topics, const std::string& name) {
  for (const std::string& topic : topics) {
    if (topic.substr(topic.rfind('/') + 1) == name) return topic;
  }
  return topics.size() == 1 ? topics.front() : "";
}

}  // namespace

BagRecording::BagRecording(const std::string& path, BagSelection selection)
    : selection_(std::move(selection)) {
  try {
    bag_.open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error("cannot read the bag " + path + ": " + error.what());
  }
  findTopics();
  readMounting();
  std::vector<std::string> topics{selection_.scan_topic, "/tf", "tf"};
  if (!selection_.odometry_topic.empty()) topics.push_back(selection_.odometry_topic);
  view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery(topics));
  message_ = view_->begin();
  message_count_ = view_->size();
}

void BagRecording::findTopics() {
  rosbag::View all(bag_);
  if (selection_.scan_topic.empty()) {
    const std::vector<std::string> scans = topicsOf(all, "sensor_msgs/LaserScan");
    selection_.scan_topic = choose(scans, "scan");
    if (selection_.scan_topic.empty()) {
      throw std::runtime_error(
          "the bag has no single topic of sensor_msgs/LaserScan to take (it has: " + listed(scans) +
          "); name one with --scan-topic");
    }
  }
  if (selection_.odometry_topic.empty()) {
    std::vector<std::string> odometry = topicsOf(all, "nav_msgs/Odometry");
    odometry.erase(std::remove_if(odometry.begin(), odometry.end(),
                                  [](const std::string& topic) {
                                    return topic.find("ground_truth") != std::string::npos;
                                  }),
                   odometry.end());
    selection_.odometry_topic = choose(odometry, "odom");
  }
}

void BagRecording::readMounting() {
  rosbag::View scans(bag_, rosbag::TopicQuery(selection_.scan_topic));
  if (scans.size() == 0)
    throw std::runtime_error("the bag has no message on " + selection_.scan_topic);
  const auto first_scan = scans.begin()->instantiate<sensor_msgs::LaserScan>();
  if (!first_scan)
    throw std::runtime_error(selection_.scan_topic + " does not carry sensor_msgs/LaserScan");
  const std::string laser_frame = withoutSlash(first_scan->header.frame_id);

  tf2::BufferCore transforms(ros::Duration(10.0));
  rosbag::View view(
      bag_, rosbag::TopicQuery(std::vector<std::string>{"/tf", "tf", "/tf_static", "tf_static"}));
  for (const rosbag::MessageInstance& message : view) {
    const auto batch = message.instantiate<tf2_msgs::TFMessage>();
    if (!batch) continue;
    for (geometry_msgs::TransformStamped transform : batch->transforms) {
      transform.header.frame_id = withoutSlash(transform.header.frame_id);
      transform.child_frame_id = withoutSlash(transform.child_frame_id);
      transforms.setTransform(transform, "bag",
                              message.getTopic().find("static") != std::string::npos);
    }
    if (!transforms.canTransform(selection_.base_frame, laser_frame, ros::Time(0))) continue;
    const auto found = transforms.lookupTransform(selection_.base_frame, laser_frame, ros::Time(0));
    const ram_slam_ros::Mounting mounting = ram_slam_ros::toMounting(found.transform);
    base_from_laser_ = mounting.base_from_sensor;
    upside_down_ = mounting.upside_down;
    return;
  }
  throw std::runtime_error("the bag has no transform from '" + laser_frame + "' to '" +
                           selection_.base_frame +
                           "' on /tf or /tf_static; frames: " + transforms.allFramesAsString());
}

std::optional<BagRecording::Reading> BagRecording::next() {
  while (message_ != view_->end() && !ready()) {
    take(*message_);
    ++message_;
    ++messages_read_;
  }
  if (waiting_.empty()) return std::nullopt;
  auto first = waiting_.begin();
  given_ns_ = first->first.first;
  std::optional<Reading> reading(std::move(first->second));
  waiting_.erase(first);
  return reading;
}

bool BagRecording::ready() const {
  return !waiting_.empty() && newest_ns_ - waiting_.begin()->first.first > kReorderingWindowNs;
}

double BagRecording::progress() const {
  return message_count_ == 0
             ? 1.0
             : static_cast<double>(messages_read_) / static_cast<double>(message_count_);
}

std::vector<std::string> BagRecording::notes() const {
  std::vector<std::string> notes{
      "scans: " + std::to_string(scan_count_) + " of " + selection_.scan_topic,
      "odometry: " + std::to_string(odometry_count_) + " of " +
          (selection_.odometry_topic.empty()
               ? "tf " + selection_.odom_frame + " -> " + selection_.base_frame
               : selection_.odometry_topic)};
  for (const auto& [reason, count] : left_out_)
    notes.push_back("left out " + std::to_string(count) + ": " + reason);
  return notes;
}

void BagRecording::take(const rosbag::MessageInstance& message) {
  try {
    if (const auto scan = message.instantiate<sensor_msgs::LaserScan>()) {
      takeScan(*scan);
    } else if (const auto odometry = message.instantiate<nav_msgs::Odometry>()) {
      takeOdometry(toNanoseconds(odometry->header.stamp),
                   ram_slam_ros::toPose2(odometry->pose.pose));
    } else if (const auto transforms = message.instantiate<tf2_msgs::TFMessage>()) {
      if (selection_.odometry_topic.empty()) takeTransforms(*transforms);
    }
  } catch (const std::invalid_argument& error) {
    ++left_out_[error.what()];
  }
}

void BagRecording::takeScan(const sensor_msgs::LaserScan& message) {
  ram_slam::MountedScan reading{ram_slam_ros::toLaserScan(message), base_from_laser_};
  if (upside_down_) reading.scan = ram_slam::mirrored(reading.scan);
  push({reading.scan.stamp_ns, kScanSecond}, std::move(reading));
  ++scan_count_;
}

void BagRecording::takeOdometry(std::int64_t stamp_ns, const ram_slam::Pose2& odom_from_base) {
  push({stamp_ns, kOdometryFirst}, ram_slam::StampedPose2{stamp_ns, odom_from_base});
  ++odometry_count_;
}

void BagRecording::takeTransforms(const tf2_msgs::TFMessage& message) {
  for (const geometry_msgs::TransformStamped& transform : message.transforms) {
    if (withoutSlash(transform.header.frame_id) != selection_.odom_frame ||
        withoutSlash(transform.child_frame_id) != selection_.base_frame) {
      continue;
    }
    takeOdometry(toNanoseconds(transform.header.stamp), ram_slam_ros::toPose2(transform.transform));
  }
}

void BagRecording::push(Key key, Reading reading) {
  if (key.first < given_ns_) throw std::invalid_argument("more than 1 s out of order");
  newest_ns_ = std::max(newest_ns_, key.first);
  waiting_.emplace(key, std::move(reading));
}

}  // namespace ramscout_bringup_ros
