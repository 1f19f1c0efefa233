// SPDX-License-Identifier: BSD-3-Clause
// What a recording holds and what is wrong with it, without mapping.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <variant>

#include <CLI/CLI.hpp>

#include "ramscout_bringup/recording.hpp"

#include "../ros/recording_options.hpp"
#include "../ros/ros_recording.hpp"

namespace {

/// What the readings of a recording add up to.
struct Content {
  std::size_t scans = 0;
  std::size_t hits = 0;
  std::size_t nothing = 0;
  std::size_t useless = 0;  ///< too close, or no information
  double longest_gap_s = 0.0;
  double gap_at_s = 0.0;
  double duration_s = 0.0;
  double distance_m = 0.0;  ///< by odometry
  double turn_rad = 0.0;
};

class Reviewer {
public:
  void add(const ram_slam::MountedScan& mounted) {
    const ram_slam::LaserScan& scan = mounted.scan;
    if (content_.scans++ == 0) first_ns_ = last_ns_ = scan.stamp_ns;
    const double gap_s = 1e-9 * static_cast<double>(scan.stamp_ns - last_ns_);
    if (gap_s > content_.longest_gap_s) {
      content_.longest_gap_s = gap_s;
      content_.gap_at_s = 1e-9 * static_cast<double>(last_ns_ - first_ns_);
    }
    last_ns_ = scan.stamp_ns;
    content_.duration_s = 1e-9 * static_cast<double>(last_ns_ - first_ns_);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const ram_slam::Return reading = scan.at(i);
      if (reading == ram_slam::Return::kHit) {
        ++content_.hits;
      } else if (reading == ram_slam::Return::kNothing) {
        ++content_.nothing;
      } else {
        ++content_.useless;
      }
    }
  }
  void add(const ram_slam::StampedPose2& odometry) {
    if (last_odometry_) {
      const ram_slam::Pose2 step = last_odometry_->inverse() * odometry.pose;
      content_.distance_m += step.translation().norm();
      content_.turn_rad += std::abs(step.yaw_rad);
    }
    last_odometry_ = odometry.pose;
  }
  const Content& content() const { return content_; }

private:
  Content content_;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::optional<ram_slam::Pose2> last_odometry_;
};

void print(const Content& content) {
  const auto share = [&](std::size_t count) {
    const auto all = static_cast<double>(content.hits + content.nothing + content.useless);
    return all > 0.0 ? 100.0 * static_cast<double>(count) / all : 0.0;
  };
  std::printf("%zu usable scans over %.1f s; longest gap %.2f s, %.1f s after the first scan\n",
              content.scans, content.duration_s, content.longest_gap_s, content.gap_at_s);
  std::printf("readings: %.1f %% hits, %.1f %% nothing came back, %.1f %% no information\n",
              share(content.hits), share(content.nothing), share(content.useless));
  std::printf("odometry: %.1f m, turns of %.0f deg in all\n", content.distance_m,
              content.turn_rad * 180.0 / M_PI);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Reports what a recording holds and what is wrong with it: topics, frames, order, rates, "
      "gaps, "
      "readings. Exit code 1 if it cannot be mapped.");
  std::string input;
  ramscout_bringup::RecordingOptions options;
  app.add_option("input", input, "as for run_bag")->required()->check(CLI::ExistingPath);
  ramscout_bringup_ros::addOptions(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    const auto recording = ramscout_bringup_ros::openRecording(input, options);
    Reviewer reviewer;
    while (const auto reading = recording->next())
      std::visit([&](const auto& value) { reviewer.add(value); }, *reading);
    for (const std::string& note : recording->notes()) std::cout << note << "\n";
    print(reviewer.content());
    if (2 * reviewer.content().scans >= recording->scanCount()) return EXIT_SUCCESS;
    std::cerr << "bag_check: fewer than half of the scans are usable\n";
  } catch (const std::exception& error) {
    std::cerr << "bag_check: " << error.what() << "\n";
  }
  return EXIT_FAILURE;
}
