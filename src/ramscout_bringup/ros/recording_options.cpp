// SPDX-License-Identifier: BSD-3-Clause
#include "recording_options.hpp"

#include <cmath>
#include <map>
#include <vector>

namespace ramscout_bringup_ros {
namespace {

constexpr double kRadPerDegree = M_PI / 180.0;

void addGeometry(CLI::App& app, ramscout_bringup::RecordingOptions& options) {
  app.add_option_function<std::vector<double>>(
         "--mount",
         [&options](const std::vector<double>& mount) {
           options.base_from_laser = ram_slam::Pose2{mount[0], mount[1], mount[2]};
         },
         "where the laser is on the base: x,y,yaw in metres and radians; default: from tf or the "
         "log")
      ->delimiter(',')
      ->expected(3);
  app.add_option_function<double>(
         "--fov", [&options](double fov_deg) { options.fov_rad = fov_deg * kRadPerDegree; },
         "angle from the first to the last beam of FLASER lines [deg]; default: by the number of "
         "beams")
      ->check(CLI::Range(1.0, 360.0));
  const std::map<std::string, ram_slam::SweepDirection> directions{
      {"as-stored", ram_slam::SweepDirection::kAsStored},
      {"counterclockwise", ram_slam::SweepDirection::kCounterclockwise},
      {"clockwise", ram_slam::SweepDirection::kClockwise}};
  app.add_option("--sweep-direction", options.sweep_direction,
                 "how the lidar turns, seen from above, if its driver sorts the readings: "
                 "as-stored, counterclockwise or clockwise")
      ->transform(CLI::CheckedTransformer(directions, CLI::ignore_case));
}

void addTime(CLI::App& app, ramscout_bringup::RecordingOptions& options) {
  app.add_option("--scan-clock-offset", options.scan_clock_offset_s,
                 "added to the stamps of the scans [s], where they have another clock");
  app.add_option("--start", options.start_s, "skip so much from the first scan on [s]")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--duration", options.duration_s, "read so much from there on [s]")
      ->check(CLI::PositiveNumber);
  app.add_option("--max-rate", options.max_rate_hz, "thin the scans out to that rate [Hz]")
      ->check(CLI::PositiveNumber);
  app.add_option("--part", options.part,
                 "which drive to read, from 1, if the clock was set back in between");
}

}  // namespace

void addOptions(CLI::App& app, ramscout_bringup::RecordingOptions& options) {
  app.add_option("--scan-topic", options.scan_topic,
                 "default: the topic called scan, or the only one of its type");
  app.add_option("--odom-topic", options.odometry_topic,
                 "default: the topic called odom, the only one of its type, or tf");
  app.add_option("--odom-frame", options.odom_frame,
                 "frame of the odometry on tf; default: odom, or the parent of the robot's frame");
  app.add_option(
      "--base-frame", options.base_frame,
      "the robot's frame; default: base_link, the odometry's child frame, base_footprint, "
      "or what the laser is fixed to");
  addGeometry(app, options);
  addTime(app, options);
}

}  // namespace ramscout_bringup_ros
