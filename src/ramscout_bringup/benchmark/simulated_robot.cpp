// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_robot.hpp"

#include <cmath>
#include <stdexcept>

namespace ramscout_bringup {
namespace {

using ram_slam::Pose2;

constexpr std::size_t kKept = 100;  // readings of the wheels

ramscout_sim::SimulatorNodeParameters simulatorParameters(const ParameterFiles& files, int seed) {
  ram_parameters::ParameterReader reader = files.reader("simulator");
  ramscout_sim::SimulatorNodeParameters parameters =
      ramscout_sim::readSimulatorNodeParameters(reader);
  parameters.simulation.seed = seed;
  return parameters;
}

Pose2 planar(const Eigen::Isometry3d& pose) {
  return {pose.translation().x(), pose.translation().y(),
          std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))};
}

}  // namespace

SimulatedRobot::SimulatedRobot(const ParameterFiles& files,
                               const ramscout_sim::World& world,
                               int seed,
                               double heading_offset_rad)
    : world_(world),
      parameters_(simulatorParameters(files, seed)),
      robot_(ramscout_sim::readRobot(
          files.urdf(), parameters_.every_robot.laser_frame, parameters_.robot_limits)),
      simulation_(parameters_.simulation, robot_, world_, std::nullopt),
      base_from_laser_(planar(robot_.base_from_laser)),
      heading_offset_rad_(
          robot_.kind == ramscout_sim::BaseKind::kOmnidirectional ? heading_offset_rad : 0.0) {}

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
  const ramscout_sim::LidarParameters& lidar = parameters_.simulation.lidar;
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

ramscout_sim::Twist2 SimulatedRobot::wantedTwist(ramscout_sim::TourDriver& driver) const {
  ramscout_sim::Pose2 world_from_way = worldFromBase();
  world_from_way.yaw_rad -= heading_offset_rad_;
  const ramscout_sim::Twist2 along = driver.drive(world_from_way);
  return {along.forward_mps * std::cos(heading_offset_rad_),
          -along.forward_mps * std::sin(heading_offset_rad_), along.turn_radps};
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
    simulation_.command(wantedTwist(driver));
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
