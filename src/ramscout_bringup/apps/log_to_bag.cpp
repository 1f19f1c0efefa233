// SPDX-License-Identifier: BSD-3-Clause
// A CARMEN log as a ROS bag, for `rosbag play` and rviz.
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <variant>

#include <CLI/CLI.hpp>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <ram_slam/ros/conversions.hpp>
#include <rosbag/bag.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include "ramscout_bringup/carmen_recording.hpp"

namespace {

using ram_slam::MountedScan;
using ram_slam::StampedPose2;

constexpr double kStaticTransformPeriodS = 10.0;  // so that playing may begin anywhere

geometry_msgs::TransformStamped toTransform(std::int64_t stamp_ns,
                                            const char* parent,
                                            const char* child,
                                            const ram_slam::Pose2& parent_from_child) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ram_slam_ros::toTime(stamp_ns);
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform = ram_slam_ros::toTransformMessage(parent_from_child);
  return transform;
}

class BagWriter {
public:
  explicit BagWriter(const std::string& path)
      : bag_(std::make_unique<rosbag::Bag>(path, rosbag::bagmode::Write)) {
    bag_->setCompression(rosbag::compression::LZ4);
  }
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;
  /// Of a bag that could not be closed, the destructor would end the process: it is left to the
  /// system.
  ~BagWriter() { static_cast<void>(bag_.release()); }

  void close() {
    bag_->close();
    bag_.reset();
  }

  void write(const StampedPose2& reading) {
    nav_msgs::Odometry odometry;
    odometry.header.stamp = ram_slam_ros::toTime(reading.stamp_ns);
    odometry.header.frame_id = "odom";
    odometry.child_frame_id = "base_link";
    odometry.pose.pose = ram_slam_ros::toPoseMessage(reading.pose);
    bag_->write("/odom", odometry.header.stamp, odometry);
    tf2_msgs::TFMessage transforms;
    transforms.transforms.push_back(
        toTransform(reading.stamp_ns, "odom", "base_link", reading.pose));
    bag_->write("/tf", odometry.header.stamp, transforms);
  }

  void write(const MountedScan& reading) {
    const ros::Time stamp = ram_slam_ros::toTime(reading.scan.stamp_ns);
    if (mount_written_.isZero() || (stamp - mount_written_).toSec() > kStaticTransformPeriodS) {
      tf2_msgs::TFMessage transforms;
      transforms.transforms.push_back(
          toTransform(reading.scan.stamp_ns, "base_link", "laser", reading.base_from_laser));
      bag_->write("/tf_static", stamp, transforms);
      mount_written_ = stamp;
    }
    sensor_msgs::LaserScan message = ram_slam_ros::toScanMessage(reading.scan);
    message.header.frame_id = "laser";
    bag_->write("/scan", stamp, message);
  }

private:
  std::unique_ptr<rosbag::Bag> bag_;
  ros::Time mount_written_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Writes a CARMEN log as a ROS bag: scan, odom, tf from odom to base_link, tf_static to "
      "laser.");
  std::string input;
  std::string output;
  app.add_option("input", input, "CARMEN log (.clf, .log, also .gz, .xz)")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("output", output, "bag to write")->required();
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of file sizes is an error of writing like others
  const std::string unfinished = output + ".active";
  try {
    ramscout_bringup::CarmenRecording recording(input);
    BagWriter bag(unfinished);
    while (auto reading = recording.next())
      std::visit([&](const auto& value) { bag.write(value); }, *reading);
    bag.close();
    std::filesystem::rename(unfinished, output);
    for (const std::string& note : recording.notes()) std::cout << note << "\n";
  } catch (const std::exception& error) {
    std::cerr << "log_to_bag: " << output << " was not written: " << error.what() << "\n";
    std::error_code none;
    std::filesystem::remove(unfinished, none);
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
