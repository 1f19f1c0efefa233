// SPDX-License-Identifier: BSD-3-Clause
#include "grade.hpp"

#include <ctime>

#include <ramscout_sim/map_image.hpp>
#include <sys/resource.h>

#include "ramscout_bringup/evaluation.hpp"
#include "ramscout_bringup/map_quality.hpp"
#include "ramscout_bringup/slam_pipeline.hpp"

#include "simulated_robot.hpp"

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

constexpr double kPiece_m = 5.0;  // of the path, for the relative error

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
  const ramscout_sim::World world = ramscout_sim::readWorld(scenario.world);
  SimulatedRobot robot(config, world, seed);
  for (const ramscout_sim::Fault& fault : scenario.faults) robot.inject(fault);
  ramscout_sim::TourDriver driver(ramscout_sim::readTour(scenario.tour));
  SlamPipeline pipeline(readSlamParameters(config, scenario.estimator));
  const double height_m = robot.laserHeight_m();
  const std::int64_t start_ns = robot.now_ns();
  const auto driven_s = [&] { return 1e-9 * static_cast<double>(robot.now_ns() - start_ns); };
  Trajectory truth;
  double cpu_s = 0.0;
  while (driver.progress() < 1.0 && driven_s() < scenario.most_s) {
    SimulatedRobot::Reading reading = robot.drive(driver);
    const std::int64_t stamp_ns = reading.scan.stamp_ns;
    truth.push_back({stamp_ns, reading.start_from_base});
    cpu_s += cpuOf([&] {
      pipeline.add({stamp_ns, reading.odom_from_base});
      pipeline.add(ram_slam::MountedScan{std::move(reading.scan), robot.baseFromLaser()});
    });
  }
  Grade grade;
  cpu_s += cpuOf([&] { grade.results = pipeline.finish(); });
  grade.results.ground_truth = std::move(truth);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  grade.figures["tour_driven"] = driver.progress();
  grade.figures["times_lost"] = grade.results.summary["times_lost"];
  grade.figures["cpu_s_per_s"] = cpu_s / driven_s();
  grade.figures["peak_memory_mb"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
  judgePath(grade);
  judgeMap(grade, world, height_m);
  return grade;
}

}  // namespace ramscout_bringup
