// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include "ramscout_bringup/recording.hpp"

namespace ramscout_bringup_ros {

/// Topics and frames to read; an empty name is looked for in the bag.
struct BagSelection {
  std::string scan_topic;      ///< sensor_msgs/LaserScan; default: `scan`, else the bag's only one
  std::string odometry_topic;  ///< nav_msgs/Odometry; default: `odom`, else tf from odom_frame to
                               ///< base_frame
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
};

/// A ROS bag as a recording. Messages are put in the order of their header stamps within one
/// second; one that comes later still is left out and counted in the notes. Needs no master.
class BagRecording : public ramscout_bringup::Recording {
public:
  /// \throws std::runtime_error if the bag cannot be opened, has no scan topic (the message lists
  /// the topics it has),
  ///         or does not contain where the laser is mounted
  BagRecording(const std::string& path, BagSelection selection);

  std::optional<Reading> next() override;
  double progress() const override;
  std::vector<std::string> notes() const override;

private:
  using Key = std::pair<std::int64_t,
                        int>;  ///< stamp and kind: odometry sorts before a scan of the same stamp

  void findTopics();
  void readMounting();
  void take(const rosbag::MessageInstance& message);
  void takeScan(const sensor_msgs::LaserScan& message);
  void takeOdometry(std::int64_t stamp_ns, const ram_slam::Pose2& odom_from_base);
  void takeTransforms(const tf2_msgs::TFMessage& message);
  void push(Key key, Reading reading);
  bool ready() const;

  rosbag::Bag bag_;
  BagSelection selection_;
  ram_slam::Pose2 base_from_laser_;
  bool upside_down_ = false;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator message_;
  std::size_t message_count_ = 0;
  std::size_t messages_read_ = 0;
  std::multimap<Key, Reading> waiting_;
  std::int64_t newest_ns_ = 0;
  std::int64_t given_ns_ = 0;
  int scan_count_ = 0;
  int odometry_count_ = 0;
  std::map<std::string, int> left_out_;
};

}  // namespace ramscout_bringup_ros
