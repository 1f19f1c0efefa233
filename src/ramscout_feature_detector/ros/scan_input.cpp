// SPDX-License-Identifier: BSD-3-Clause
#include "scan_input.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "ram_slam/ros/conversions.hpp"

namespace ramscout_feature_detector_ros {
namespace {

/// A frame without the leading slash that tf2 refuses.
std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

bool isDuration(float seconds) {
  return std::isfinite(seconds) && seconds >= 0.0F;
}

/// What is wrong with a message that can be used all the same, and what is made of it.
/// \param scan  what was made of it
std::vector<std::string> oddities(const sensor_msgs::LaserScan& message,
                                  const ram_slam::LaserScan& scan) {
  std::vector<std::string> found;
  const double beams =
      (static_cast<double>(message.angle_max) - message.angle_min) / message.angle_increment + 1.0;
  if (!(std::abs(beams - static_cast<double>(message.ranges.size())) <= 1.0)) {
    found.push_back("number of ranges does not agree with its angles; angle_max is not used");
  }
  if (message.time_increment != 0.0F && scan.time_increment_s == 0.0) {
    found.push_back("time_increment is no plausible duration; taken as measured at once");
  }
  if (!ram_slam_ros::hasRangeLimit(message)) {
    found.push_back("range_max is no limit; 100 m is assumed");
  }
  if (!isDuration(message.scan_time)) found.push_back("scan_time is no duration; it is not used");
  if (!message.intensities.empty() && message.intensities.size() != message.ranges.size()) {
    found.push_back("number of intensities differs from that of ranges; they are not used");
  }
  if (message.header.frame_id.front() == '/') {
    found.push_back("frame_id begins with a slash, which is left out");
  }
  return found;
}

/// Whether no reading contains information, as of a laser that is covered or broken.
bool isBlind(const ram_slam::LaserScan& scan) {
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const ram_slam::Return seen = scan.at(beam);
    if (seen == ram_slam::Return::kHit || seen == ram_slam::Return::kNothing) return false;
  }
  return true;
}

}  // namespace

ScanInput::ScanInput(const ramscout_feature_detector::DetectorNodeParameters& parameters,
                     const std::string& output,
                     Callback use)
    : parameters_(parameters),
      use_(std::move(use)),
      tf_listener_(tf_buffer_),
      scan_subscriber_(ros::NodeHandle().subscribe(
          "scan", 100, &ScanInput::onScan, this, ros::TransportHints().tcpNoDelay())),
      diagnostics_(ram_slam::Link::kFeatures, "features", [this] { return report(); }),
      scan_input_(
          diagnostics_.watch<sensor_msgs::LaserScan>(scan_subscriber_, ram_slam_ros::scanInput())) {
  diagnostics_.needMount(tf_buffer_, parameters_.base_frame);
  diagnostics_.setOutput(output);
}

ram_slam_ros::NodeDiagnostics::Report ScanInput::report() const {
  ram_slam_ros::NodeDiagnostics::Report report;
  report.drops = drops_;
  report.messages = messages_;
  return report;
}

void ScanInput::onScan(const ros::MessageEvent<const sensor_msgs::LaserScan>& event) {
  const sensor_msgs::LaserScan& message = *event.getMessage();
  diagnostics_.arrived(scan_input_, event);
  messages_.add(event.getPublisherName(), message.header.seq);
  const std::int64_t stamp_ns = ram_slam_ros::toNanoseconds(message.header.stamp);
  try {
    process(message);
    diagnostics_.answered(stamp_ns);
  } catch (const tf2::TransformException& error) {
    drops_.add(ram_slam::DropReason::kNoMount, stamp_ns, error.what());
  } catch (const std::exception& error) {
    drops_.add(ram_slam::DropReason::kInvalidScan, stamp_ns, error.what());
    diagnostics_.refused(scan_input_, error.what());
    ROS_WARN_STREAM_THROTTLE(parameters_.log_period_s, "Skipped a scan: " << error.what());
  }
}

void ScanInput::process(const sensor_msgs::LaserScan& message) {
  const std::string laser_frame = withoutSlash(message.header.frame_id);
  if (laser_frame.empty()) throw std::invalid_argument("its frame_id is empty");
  ram_slam::LaserScan scan = ram_slam_ros::toLaserScan(message);
  const ram_slam_ros::Mounting mounting = mountingOf(laser_frame);
  ros::Time& last_stamp = last_stamps_[laser_frame];
  if (message.header.stamp == last_stamp) return;  // the same message again
  last_stamp = message.header.stamp;
  // Usual, and no reason to worry.
  const std::string at_limit = "readings at range_max; taken to mean that nothing came back";
  if (ram_slam_ros::countAtLimit(message) > 0 && warned_.insert(laser_frame + at_limit).second)
    ROS_INFO_STREAM("Scan of " << laser_frame << ": " << at_limit);
  for (const std::string& oddity : oddities(message, scan)) {
    if (warned_.insert(laser_frame + oddity).second) {
      ROS_WARN_STREAM("Scan of " << laser_frame << ": " << oddity << " (warned once)");
    }
  }
  if (isBlind(scan)) {
    ROS_WARN_STREAM_THROTTLE(parameters_.log_period_s,
                             "Scan of " << laser_frame << ": no reading contains information");
  }
  if (mounting.upside_down) scan = ram_slam::mirrored(std::move(scan));
  use_(scan, mounting.base_from_sensor);
}

ram_slam_ros::Mounting ScanInput::mountingOf(const std::string& laser_frame) {
  const auto known = mountings_.find(laser_frame);
  if (known != mountings_.end()) return known->second;
  if (mountings_.size() >= static_cast<std::size_t>(parameters_.max_lasers)) {
    throw std::invalid_argument("more than " + std::to_string(parameters_.max_lasers) +
                                " laser frames");
  }
  const auto transform =
      tf_buffer_.lookupTransform(parameters_.base_frame, laser_frame, ros::Time(0));
  const ram_slam_ros::Mounting mounting = ram_slam_ros::toMounting(transform.transform);
  mountings_[laser_frame] = mounting;
  ROS_INFO_STREAM("Laser " << laser_frame << (mounting.upside_down ? " (upside down)" : "")
                           << " at " << mounting.base_from_sensor.x_m << ", "
                           << mounting.base_from_sensor.y_m << " m, "
                           << mounting.base_from_sensor.yaw_rad << " rad");
  return mounting;
}

}  // namespace ramscout_feature_detector_ros
