// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/ros/simulator_parameters.hpp"

#include <set>
#include <stdexcept>

#include <ros/names.h>
#include <ros/param.h>

namespace ramscout_sim_ros {
namespace {

constexpr double kMaxRealTimeFactor = 1000.0;

void readRobot(ram_parameters::ParameterReader& reader, RobotParameters& robot) {
  reader.read("start", robot.start);
  reader.read("tour", robot.tour);
  reader.read("robot", robot.robot);
  reader.read("faults", robot.faults);
  reader.read("laser_frame", robot.laser_frame);
}

ramscout_sim::RobotDescription loadRobot(const RobotParameters& robot) {
  if (!robot.robot.empty()) return ramscout_sim::readRobot(robot.robot, robot.laser_frame);
  std::string urdf;
  if (!ros::param::get("robot_description", urdf)) {
    throw std::invalid_argument(
        "neither the parameter robot nor robot_description is set: which robot?");
  }
  return ramscout_sim::parseRobot(urdf, robot.laser_frame);
}

}  // namespace

bool isRate(double real_time_factor) {
  return real_time_factor >= 0.0 && real_time_factor <= kMaxRealTimeFactor;
}

void SimulatorParameters::validate() const {
  if (!isRate(real_time_factor)) {
    throw std::invalid_argument("real_time_factor must be in [0, 1000], got " +
                                std::to_string(real_time_factor));
  }
  if (!(clock_rate_hz > 0.0 && clock_rate_hz <= simulation.physics_rate_hz)) {
    throw std::invalid_argument("clock_rate_hz must be in (0, physics_rate_hz], got " +
                                std::to_string(clock_rate_hz));
  }
  std::set<std::string> names;
  for (const RobotParameters& robot : robots) {
    std::string error;
    const bool is_name = robot.name.find('/') == std::string::npos &&
                         robot.name.find('~') == std::string::npos &&
                         ros::names::validate(robot.name, error);
    if (!is_name)
      throw std::invalid_argument("robots: '" + robot.name + "' is no name for a robot");
    if (!names.insert(robot.name).second)
      throw std::invalid_argument("robots: there are two called '" + robot.name + "'");
    if (!robot.start.empty() && robot.start.size() != 3)
      throw std::invalid_argument("start must be [x, y, yaw] or empty");
  }
  lock_step.validate();
}

SimulatorParameters readSimulatorParameters(ram_parameters::ParameterReader& reader) {
  SimulatorParameters p;
  RobotParameters every;
  std::vector<std::string> names;
  reader.read("world", p.world);
  readRobot(reader, every);
  reader.read("robots", names);
  for (const std::string& name : names) {
    RobotParameters robot = every;
    robot.name = name;
    ram_parameters::ParameterReader section = reader.section(name);
    readRobot(section, robot);
    section.rejectUnknown();
    p.robots.push_back(robot);
  }
  if (names.empty()) p.robots.push_back(every);
  reader.read("real_time_factor", p.real_time_factor);
  reader.read("clock_rate_hz", p.clock_rate_hz);
  reader.read("lock_step_topics", p.lock_step.topics);
  reader.read("lock_step_timeout_s", p.lock_step.timeout_s);
  reader.read("lock_step_start_timeout_s", p.lock_step.start_timeout_s);
  p.simulation = ramscout_sim::readSimulationParameters(reader);
  reader.rejectUnknown();
  p.validate();
  return p;
}

std::vector<ramscout_sim::FleetMember> loadMembers(const SimulatorParameters& parameters,
                                                   const ramscout_sim::World& world) {
  std::vector<ramscout_sim::FleetMember> members;
  for (const RobotParameters& robot : parameters.robots) {
    ramscout_sim::FleetMember member;
    member.parameters = parameters.simulation;
    member.parameters.seed += static_cast<int>(members.size());
    member.robot = loadRobot(robot);
    member.start = world.start;
    if (!robot.start.empty()) member.start = {robot.start[0], robot.start[1], robot.start[2]};
    if (!robot.tour.empty()) member.tour = ramscout_sim::readTour(robot.tour);
    if (!robot.faults.empty()) member.faults = ramscout_sim::readFaults(robot.faults);
    members.push_back(std::move(member));
  }
  return members;
}

}  // namespace ramscout_sim_ros
