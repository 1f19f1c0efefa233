// SPDX-License-Identifier: BSD-3-Clause
// Drives generated offices in simulation, and reports how good an estimator is there: each seed is
// another building and other noise. Docs: docs/fast_slam.md, docs/ekf_slam.md.
//
//   simulated_tours --config DIR [--config DIR ...] [--estimator NAME] FIRST_SEED COUNT [METRES]

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <ram_slam/scan_matching/laser_odometry.hpp>
#include <ramscout_feature_detector/feature_detector.hpp>
#include <ramscout_sim/office.hpp>

#include "filter_score.hpp"
#include "simulated_robot.hpp"

namespace {

using namespace ramscout_bringup;

constexpr int kBlocks = 2;

/// The tour of the office, again from its beginning until it is long enough.
ramscout_sim::Tour longTour(const ramscout_sim::Tour& once, double length_m) {
  ramscout_sim::Tour tour = once;
  while (tour.length_m() < length_m) {
    const Eigen::Vector2d end_m = tour.waypoints_m.back();
    for (const Eigen::Vector2d& point_m : once.waypoints_m)
      if (point_m != end_m || tour.waypoints_m.back() != end_m) tour.waypoints_m.push_back(point_m);
  }
  return tour;
}

struct Recorded {
  std::vector<FilterStep> steps;
  ram_slam::Trajectory truth;
  double length_m = 0.0;
};

Recorded record(const std::string& config,
                const SlamParameters& parameters,
                int seed,
                double length_m) {
  ramscout_sim::OfficeParameters office_parameters;
  office_parameters.seed = seed;
  office_parameters.blocks_along_x = kBlocks;
  const ramscout_sim::Office office = ramscout_sim::generateOffice(office_parameters);
  const ramscout_sim::Tour tour = longTour(office.tour, length_m);
  SimulatedRobot robot(ParameterFiles(config, kReferenceRobot), office.world, seed);
  ramscout_sim::TourDriver driver(tour);
  ram_slam::LaserOdometry odometry(parameters.laser_odometry);
  ramscout_feature_detector::FeatureDetector detector(parameters.feature_detector);
  Recorded recorded;
  recorded.length_m = tour.length_m();
  while (driver.progress() < 1.0) {
    SimulatedRobot::Reading reading = robot.drive(driver);
    const auto estimate =
        odometry.update(reading.scan, robot.baseFromLaser(), reading.odom_from_base);
    recorded.truth.push_back({reading.scan.stamp_ns, reading.start_from_base});
    FilterStep step;
    step.features = detector.detect(reading.scan, robot.baseFromLaser());
    step.odom_from_base = estimate.odom_from_base.pose;
    step.scan = {std::move(reading.scan), robot.baseFromLaser()};
    recorded.steps.push_back(std::move(step));
  }
  return recorded;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Evaluates an estimator in generated, simulated offices.");
  std::vector<std::string> configs;
  int first = 1;
  int count = 10;
  double length_m = 200.0;
  std::string estimator = "fast_slam";
  app.add_option("--config", configs, "folder of parameter files; may be given more than once")
      ->required()
      ->allow_extra_args(false);
  app.add_option("--estimator", estimator, "name of the estimator");
  app.add_option("FIRST_SEED", first);
  app.add_option("COUNT", count);
  app.add_option("METRES", length_m, "least length of the tour");
  CLI11_PARSE(app, argc, argv);
  try {
    for (int seed = first; seed < first + count; ++seed) {
      const Recorded recorded =
          record(configs.front(), readSlamParameters(configs.front()), seed, length_m);
      for (const std::string& config : configs) {
        const SlamParameters parameters = readSlamParameters(config, estimator);
        const std::string name = "seed " + std::to_string(seed) + ", " +
                                 std::to_string(std::lround(recorded.length_m)) + " m, " + config;
        print(name + ", filter",
              scoreFilter(parameters, Judged::kFilter, recorded.steps, recorded.truth));
        print(name + ", deployed",
              scoreFilter(parameters, Judged::kDeployed, recorded.steps, recorded.truth));
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
