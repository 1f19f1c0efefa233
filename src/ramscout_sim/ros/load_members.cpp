// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/load_members.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include <ros/param.h>

namespace ramscout_sim_ros {
namespace {

using ramscout_sim::RobotParameters;

ramscout_sim::RobotDescription loadRobot(const RobotParameters& robot,
                                         const ramscout_sim::RobotLimits& limits) {
  if (!robot.robot.empty()) return ramscout_sim::readRobot(robot.robot, robot.laser_frame, limits);
  std::string urdf;
  if (!ros::param::get("robot_description", urdf)) {
    throw std::invalid_argument(
        "neither the parameter robot nor robot_description is set: which robot?");
  }
  return ramscout_sim::parseRobot(urdf, robot.laser_frame, limits);
}

}  // namespace

std::vector<ramscout_sim::FleetMember> loadMembers(
    const ramscout_sim::SimulatorNodeParameters& parameters, const ramscout_sim::World& world) {
  std::vector<ramscout_sim::FleetMember> members;
  for (const RobotParameters& robot : parameters.robots) {
    ramscout_sim::FleetMember member;
    member.parameters = parameters.simulation;
    member.parameters.seed += static_cast<int>(members.size());
    member.robot = loadRobot(robot, parameters.robot_limits);
    member.start = world.start;
    if (!robot.start.empty()) member.start = {robot.start[0], robot.start[1], robot.start[2]};
    if (!robot.tour.empty()) member.tour = ramscout_sim::readTour(robot.tour);
    if (!robot.faults.empty()) member.faults = ramscout_sim::readFaults(robot.faults);
    members.push_back(std::move(member));
  }
  return members;
}

}  // namespace ramscout_sim_ros
