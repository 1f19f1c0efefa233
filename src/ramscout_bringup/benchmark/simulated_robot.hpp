// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>

#include <ram_slam/geometry/pose2.hpp>
#include <ram_slam/geometry/trajectory.hpp>
#include <ram_slam/sensing/laser_scan.hpp>
#include <ramscout_sim/simulation.hpp>
#include <ramscout_sim/simulator_node_parameters.hpp>

#include "ramscout_bringup/parameter_files.hpp"

namespace ramscout_bringup {

/// The simulated robot, which reports what its lidar and its wheels measure at the same
/// instant, and where it really was.
class SimulatedRobot {
public:
  struct Reading {
    ram_slam::LaserScan scan;
    ram_slam::Pose2 odom_from_base;   ///< by the wheels, at the scan's stamp
    ram_slam::Pose2 start_from_base;  ///< the truth then, in the frame of where the world file
                                      ///< lets the robot start
  };

  /// \param files  with a robot
  /// \param heading_offset_rad  omnidirectional robots drive with their heading turned by this from
  /// the way, left positive; others cannot
  SimulatedRobot(const ParameterFiles& files,
                 const ramscout_sim::World& world,
                 int seed,
                 double heading_offset_rad = 0.0);

  /// Drives on to the next scan for which there is odometry.
  /// \throws std::runtime_error if a fault is due that is impossible
  Reading drive(ramscout_sim::TourDriver& driver);
  /// Carries the robot away; what it has sensed before is forgotten.
  void carryTo(const ramscout_sim::Pose2& world_from_base);

  /// \throws std::invalid_argument as Simulation::inject
  void inject(const ramscout_sim::Fault& fault) { simulation_.inject(fault); }

  /// Above the floor, where the robot stands now.
  double laserHeight_m() const;
  std::int64_t now_ns() const { return simulation_.now_ns(); }
  Eigen::Vector2d position_m() const;  ///< in the world
  const ram_slam::Pose2& baseFromLaser() const { return base_from_laser_; }
  double scanRate_hz() const { return parameters_.simulation.lidar.scan_rate_hz; }
  ram_slam::Pose2 startFromWorld(const ram_slam::Pose2& world) const;

private:
  ramscout_sim::Pose2 worldFromBase() const;
  ramscout_sim::Twist2 wantedTwist(ramscout_sim::TourDriver& driver) const;
  ram_slam::LaserScan toLaserScan(const ramscout_sim::Scan& scan) const;

  ramscout_sim::World world_;
  ramscout_sim::SimulatorNodeParameters parameters_;
  ramscout_sim::RobotDescription robot_;
  ramscout_sim::Simulation simulation_;
  ram_slam::Pose2 base_from_laser_;
  double heading_offset_rad_;
  ram_slam::Trajectory wheels_;
  ram_slam::Trajectory truth_;
  std::deque<ramscout_sim::Scan> scans_;
};

}  // namespace ramscout_bringup
