// SPDX-License-Identifier: BSD-3-Clause
// How good FastSlam alone is on recordings of which the truth is known: error, consistency of the
// covariance, false associations, landmarks. Docs: docs/fast_slam.md.
//
//   evaluate_fast_slam --config DIR [--config DIR ...] BAG TRUTH.tum [BAG TRUTH.tum ...]

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "ramscout_bringup/slam_pipeline.hpp"
#include "ramscout_bringup/trajectory_file.hpp"

#include "../benchmark/filter_score.hpp"
#include "../ros/ros_recording.hpp"

namespace {

using namespace ramscout_bringup;

/// What the detector and laser odometry make of a recording; the same for every setting of the
/// filter.
std::vector<FilterStep> prepare(const std::string& bag, const SlamParameters& parameters) {
  ramscout_bringup_ros::RosRecording recording(ramscout_bringup_ros::openBag(bag), {});
  Trajectory wheels;
  std::vector<ram_slam::MountedScan> scans;
  while (auto reading = recording.next()) {
    if (auto* odometry = std::get_if<ram_slam::StampedPose2>(&*reading)) {
      if (wheels.empty() || odometry->stamp_ns > wheels.back().stamp_ns)
        wheels.push_back({odometry->stamp_ns, odometry->pose});
    } else {
      scans.push_back(std::get<ram_slam::MountedScan>(std::move(*reading)));
    }
  }
  ram_slam::LaserOdometry odometry(parameters.laser_odometry);
  ramscout_feature_detector::FeatureDetector detector(parameters.feature_detector);
  std::vector<FilterStep> steps;
  for (ram_slam::MountedScan& scan : scans) {
    const auto estimate = odometry.update(scan.scan, scan.base_from_laser,
                                          ram_slam::poseAt(wheels, scan.scan.stamp_ns));
    steps.push_back(
        {scan, detector.detect(scan.scan, scan.base_from_laser), estimate.odom_from_base.pose});
  }
  return steps;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Evaluates FastSlam alone on recordings of which the truth is known.");
  std::vector<std::string> configs, files;
  app.add_option("--config", configs, "folder of parameter files; may be given more than once")
      ->required()
      ->allow_extra_args(false);
  app.add_option("files", files, "BAG TRUTH.tum ...")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    for (std::size_t i = 0; i + 1 < files.size(); i += 2) {
      const auto steps = prepare(files[i], readSlamParameters(configs.front()));
      const Trajectory truth = readTrajectory(files[i + 1]);
      for (const std::string& config : configs) {
        const SlamParameters parameters = readSlamParameters(config);
        print(files[i] + " " + config, scoreFilter(parameters, Judged::kFilter, steps, truth));
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
