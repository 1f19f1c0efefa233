// SPDX-License-Identifier: BSD-3-Clause
#include "grade.hpp"

#include <ctime>
#include <memory>
#include <utility>

#include <ramscout_sim/map_image.hpp>
#include <sys/resource.h>

#include "ramscout_bringup/evaluation.hpp"
#include "ramscout_bringup/map_quality.hpp"
#include "ramscout_bringup/slam_pipeline.hpp"

#include "simulated_robot.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

constexpr double kPiece_m = 5.0;    // of the path, for the relative error
constexpr int kOtherNoise = 10000;  // added to the seed of a drive that maps for another one

/// Seconds of CPU that an action takes.
template <typename Action>
double cpuOf(const Action& action) {
  const std::clock_t start = std::clock();
  action();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

ram_slam::OccupancyGrid trueMap(const ramscout_sim::World& world,
                                double height_m,
                                double resolution_m) {
  const ramscout_sim::MapImage image = ramscout_sim::drawMap(world, height_m, resolution_m);
  ram_slam::OccupancyGrid grid;
  grid.resolution_m = image.resolution_m;
  grid.map_from_grid = {image.world_from_map.x_m, image.world_from_map.y_m,
                        image.world_from_map.yaw_rad};
  grid.width = image.width_cells;
  grid.height = image.height_cells;
  for (const ramscout_sim::Cell cell : image.cells) {
    grid.cells.push_back(cell == ramscout_sim::Cell::kFree       ? ram_slam::kFreeCell
                         : cell == ramscout_sim::Cell::kOccupied ? ram_slam::kOccupiedCell
                                                                 : ram_slam::kUnknownCell);
  }
  return grid;
}

/// What a drive leaves.
struct Drive {
  Results results;
  ram_slam::LandmarkMap landmarks;
  double progress = 0.0;
  double duration_s = 0.0;
  double cpu_s = 0.0;  // of the mapping
  double laser_height_m = 0.0;
};

Drive drive(const Scenario& scenario,
            const ParameterFiles& files,
            const ramscout_sim::World& world,
            const SlamParameters& parameters,
            int seed) {
  SimulatedRobot robot(files, world, seed, scenario.heading_offset_rad);
  for (const ramscout_sim::Fault& fault : scenario.faults) robot.inject(fault);
  ramscout_sim::TourDriver driver(ramscout_sim::readTour(scenario.tour));
  SlamPipeline pipeline(parameters);
  Drive drive;
  drive.laser_height_m = robot.laserHeight_m();
  Trajectory truth;
  const std::int64_t start_ns = robot.now_ns();
  while (driver.progress() < 1.0 && drive.duration_s < scenario.most_s) {
    SimulatedRobot::Reading reading = robot.drive(driver);
    const std::int64_t stamp_ns = reading.scan.stamp_ns;
    truth.push_back({stamp_ns, reading.start_from_base});
    drive.cpu_s += cpuOf([&] {
      pipeline.add({stamp_ns, reading.odom_from_base});
      pipeline.add(ram_slam::MountedScan{std::move(reading.scan), robot.baseFromLaser()});
    });
    drive.duration_s = 1e-9 * static_cast<double>(robot.now_ns() - start_ns);
  }
  drive.cpu_s += cpuOf([&] { drive.results = pipeline.finish(); });
  drive.results.ground_truth = std::move(truth);
  drive.landmarks = pipeline.estimator().landmarks();
  drive.progress = driver.progress();
  return drive;
}

/// Where a user states in rviz that the robot stands.
ram_slam::PoseWithCovariance2 statedStart() {
  ram_slam::PoseWithCovariance2 start;
  start.covariance = Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal();
  return start;
}

/// As `slam.launch mode:=localise`: in the map of a drive with other noise.
SlamParameters localisingParameters(const Scenario& scenario,
                                    const ParameterFiles& files,
                                    const ramscout_sim::World& world,
                                    int seed) {
  const Drive before =
      drive(scenario, files, world, readSlamParameters(files, scenario.map_by), seed + kOtherNoise);
  SlamParameters parameters = readSlamParameters(files, scenario.estimator);
  parameters.use_map_smoother = false;
  parameters.estimator =
      [lost = ram_slam::startingIn(parameters.estimator, before.landmarks, {}, true)] {
        std::unique_ptr<ram_slam::Estimator> estimator = lost();
        estimator->setPose(statedStart());
        return estimator;
      };
  return parameters;
}

void judgePath(Grade& grade) {
  Results& results = grade.results;
  const TruthComparison final = compareWithTruth(results.trajectory, results.ground_truth);
  grade.figures["ate_m"] = final.position_m.rms;
  grade.figures["yaw_rms_rad"] = final.yaw_rad.rms;
  grade.figures["online_ate_m"] =
      compareWithTruth(results.trajectory_online, results.ground_truth).position_m.rms;
  grade.figures["rpe_5m_m"] =
      relativeErrors(results.trajectory, results.ground_truth, {kPiece_m}, {})
          .front()
          .position_m.rms;
}

void judgeMap(Grade& grade, const ramscout_sim::World& world, double height_m) {
  const Results& results = grade.results;
  const Pose2 world_from_start{world.start.x_m, world.start.y_m, world.start.yaw_rad};
  const Pose2 start_from_map =
      compareWithTruth(results.trajectory, results.ground_truth).truth_from_map;
  const MapAgreement agreement =
      compareMaps(results.map, trueMap(world, height_m, results.map.resolution_m),
                  world_from_start * start_from_map);
  grade.figures["map_iou"] = agreement.occupied_iou;
  grade.figures["map_coverage"] = agreement.coverage;
  grade.figures["wall_m"] = agreement.wall_distance_m.rms;
}

}  // namespace

Grade grade(const Scenario& scenario, const std::string& config, int seed) {
  const ParameterFiles files(config, scenario.robot, scenario.lidar);
  const ramscout_sim::World world = ramscout_sim::readWorld(scenario.world);
  const SlamParameters parameters = scenario.map_by.empty()
                                        ? readSlamParameters(files, scenario.estimator)
                                        : localisingParameters(scenario, files, world, seed);
  Drive driven = drive(scenario, files, world, parameters, seed);
  Grade grade;
  grade.results = std::move(driven.results);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  grade.figures["tour_driven"] = driven.progress;
  grade.figures["times_lost"] = grade.results.summary["times_lost"];
  grade.figures["cpu_s_per_s"] = driven.cpu_s / driven.duration_s;
  grade.figures["peak_memory_mb"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
  judgePath(grade);
  judgeMap(grade, world, driven.laser_height_m);
  return grade;
}

}  // namespace ramscout_bringup
