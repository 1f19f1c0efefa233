// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_robot.hpp"

#include <cmath>
#include <stdexcept>

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

constexpr std::size_t kKept = 100;  // readings of the wheels

ramscout_sim::SimulationParameters simulationParameters(const std::string& config, int seed) {
  const std::string path = config + "/simulator.yaml";
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
  ramscout_sim::SimulationParameters parameters = ramscout_sim::readSimulationParameters(reader);
  parameters.seed = seed;
  return parameters;
}

Pose2 planar(const Eigen::Isometry3d& pose) {
  return {pose.translation().x(), pose.translation().y(),
          std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))};
}

}  // namespace

SimulatedRobot::SimulatedRobot(const std::string& config,
                               const ramscout_sim::World& world,
                               int seed)
    : world_(world),
      parameters_(simulationParameters(config, seed)),
      robot_(ramscout_sim::readRobot(config + "/robots/ramscout.urdf")),
      simulation_(parameters_, robot_, world_, std::nullopt),
      base_from_laser_(planar(robot_.base_from_laser)) {}

ramscout_sim::Pose2 SimulatedRobot::worldFromBase() const {
  const Pose2 pose = planar(simulation_.groundTruth().world_from_base);
  return {pose.x_m, pose.y_m, pose.yaw_rad};
}

Eigen::Vector2d SimulatedRobot::position_m() const {
  return simulation_.groundTruth().world_from_base.translation().head<2>();
}

double SimulatedRobot::laserHeight_m() const {
  const Eigen::Isometry3d& world_from_base = simulation_.groundTruth().world_from_base;
  return (world_from_base * robot_.base_from_laser).translation().z();
}

Pose2 SimulatedRobot::startFromWorld(const Pose2& world) const {
  return Pose2{world_.start.x_m, world_.start.y_m, world_.start.yaw_rad}.inverse() * world;
}

ram_slam::LaserScan SimulatedRobot::toLaserScan(const ramscout_sim::Scan& scan) const {
  const ramscout_sim::LidarParameters& lidar = parameters_.lidar;
  ram_slam::LaserScan result;
  result.stamp_ns = scan.stamp_ns;
  result.angle_min_rad = lidar.angle_min_rad;
  result.angle_increment_rad = lidar.angleIncrement_rad();
  result.time_increment_s = lidar.time_increment_s;
  result.range_min_m = static_cast<float>(lidar.range_min_m);
  result.range_max_m = static_cast<float>(lidar.range_max_m);
  result.ranges_m = scan.ranges_m;
  return result;
}

SimulatedRobot::Reading SimulatedRobot::drive(ramscout_sim::TourDriver& driver) {
  while (true) {
    if (!scans_.empty()) {
      const std::int64_t stamp_ns = scans_.front().stamp_ns;
      const auto wheels = ram_slam::poseAt(wheels_, stamp_ns);
      const auto truth = ram_slam::poseAt(truth_, stamp_ns);
      const bool waits = wheels_.empty() || wheels_.back().stamp_ns < stamp_ns;
      if (!waits) {
        const ramscout_sim::Scan scan = std::move(scans_.front());
        scans_.pop_front();
        if (wheels && truth) return {toLaserScan(scan), *wheels, startFromWorld(*truth)};
      }
    }
    simulation_.command(driver.drive(worldFromBase()));
    ramscout_sim::Outputs outputs = simulation_.step();
    if (!outputs.refused_faults.empty()) {
      const ramscout_sim::RefusedFault& refused = outputs.refused_faults.front();
      throw std::runtime_error("fault " + toYaml(refused.fault) + ": " + refused.reason);
    }
    if (outputs.odometry) {
      const auto& pose = outputs.odometry->odom_from_base;
      wheels_.push_back({outputs.odometry->stamp_ns, {pose.x_m, pose.y_m, pose.yaw_rad}});
      truth_.push_back({outputs.odometry->stamp_ns, planar(outputs.ground_truth->world_from_base)});
      if (wheels_.size() > 2 * kKept) {
        wheels_.erase(wheels_.begin(), wheels_.begin() + kKept);
        truth_.erase(truth_.begin(), truth_.begin() + kKept);
      }
    }
    if (outputs.scan) scans_.push_back(std::move(*outputs.scan));
  }
}

void SimulatedRobot::carryTo(const ramscout_sim::Pose2& world_from_base) {
  simulation_.setPose(world_from_base);
  scans_.clear();
  wheels_.clear();
  truth_.clear();
}

}  // namespace ramscout_bringup
