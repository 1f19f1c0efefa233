// SPDX-License-Identifier: BSD-3-Clause
#include "recording_survey.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <ram_slam/ros/conversions.hpp>

namespace ramscout_bringup_ros {
namespace {

using ram_slam_ros::toNanoseconds;
using ramscout_bringup::RecordedTopic;

const std::vector<std::string> kTransformTopics{"/tf", "tf", "/tf_static", "tf_static"};

Eigen::Isometry3d toIsometry(const geometry_msgs::Transform& transform) {
  const auto& q = transform.rotation;
  const auto& t = transform.translation;
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  // Not finite for a quaternion of zeros: the tree leaves it out.
  isometry.linear() = Eigen::Quaterniond(rotation.coeffs() / rotation.norm()).toRotationMatrix();
  isometry.translation() = Eigen::Vector3d(t.x, t.y, t.z);
  return isometry;
}

class Surveyor {
public:
  explicit Surveyor(RecordingSurvey& survey) : survey_(survey) {}

  void take(const RecordedMessage& message) {
    message_ = &message;
    std::visit([this](const auto& content) { add(content); }, message.content);
  }

private:
  void add(const sensor_msgs::LaserScan& scan) {
    RecordingSurvey::Scans& scans = survey_.scans;
    if (message_->topic != scans.topic) return;
    if (scans.times.stamps_ns.empty()) {
      scans.beam_count = scan.ranges.size();
      scans.increment_rad = scan.angle_increment;
      scans.scan_time_s = scan.scan_time;
      scans.time_increment_s = scan.time_increment;
      scans.limit_m = scan.range_max;
    }
    scans.at_limit_count += ram_slam_ros::countAtLimit(scan);
    addTimes(scans.times, scan.header.stamp);
    ++scans.count_of_frame[scan.header.frame_id];
    scans.no_return.add(scan.ranges);
    if (!ram_slam_ros::hasRangeLimit(scan)) ++scans.unlimited_count;
    const double sweep_s = ram_slam_ros::sweep_s(scan);
    if (sweep_s != 0.0 && !ram_slam_ros::isPlausibleSweep(sweep_s)) ++scans.implausible_sweep_count;
  }

  void add(const nav_msgs::Odometry& odometry) {
    RecordingSurvey::Odometry& topic = survey_.odometry[message_->topic];
    const auto& twist = odometry.twist.twist;
    ramscout_bringup::OdometryReading reading{toNanoseconds(odometry.header.stamp), {}, {}};
    reading.twist = {twist.linear.x, twist.linear.y, twist.angular.z};
    try {
      reading.odom_from_child = ram_slam_ros::toPose2(odometry.pose.pose);
    } catch (const std::invalid_argument&) {
      ++topic.invalid_count;
      return;
    }
    if (!reading.twist.isFinite()) reading.twist = {};
    if (topic.readings.empty()) topic.child_frame = odometry.child_frame_id;
    topic.readings.push_back(reading);
    addTimes(topic.times, odometry.header.stamp);
  }

  void add(const tf2_msgs::TFMessage& transforms) {
    const bool is_static = message_->topic.find("static") != std::string::npos;
    for (const geometry_msgs::TransformStamped& transform : transforms.transforms) {
      survey_.tree.add(transform.header.frame_id, transform.child_frame_id,
                       toNanoseconds(transform.header.stamp), toIsometry(transform.transform),
                       is_static);
    }
  }

  void addTimes(TopicTimes& times, const ros::Time& stamp) const {
    times.stamps_ns.push_back(toNanoseconds(stamp));
    times.received_ns.push_back(message_->received_ns);
  }

  RecordingSurvey& survey_;
  const RecordedMessage* message_ = nullptr;
};

}  // namespace

RecordingSurvey survey(MessageSource& source, const ramscout_bringup::RecordingOptions& options) {
  RecordingSurvey survey;
  survey.topics = source.topics();
  survey.scans.topic = ramscout_bringup::chooseScanTopic(survey.topics, options.scan_topic);
  std::vector<std::string> topics = kTransformTopics;
  topics.push_back(survey.scans.topic);
  for (const RecordedTopic& topic : survey.topics)
    if (topic.type == "nav_msgs/Odometry") topics.push_back(topic.name);
  Surveyor surveyor(survey);
  source.restart(topics);
  while (const auto message = source.next()) surveyor.take(*message);
  survey.tree.finish();
  survey.source_notes = source.notes();
  return survey;
}

}  // namespace ramscout_bringup_ros
