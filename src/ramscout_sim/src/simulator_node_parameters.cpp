// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/simulator_node_parameters.hpp"

#include <regex>
#include <set>
#include <stdexcept>

#include "ramscout_sim/parameter_files.hpp"

namespace ramscout_sim {

const ram_parameters::ParameterTable<RobotParameters>& RobotParameters::table() {
  using namespace ram_parameters;
  using P = RobotParameters;
  static const auto table =
      ParameterTable<P>()
          .add("tour", &P::tour,
               "Tour file: the robot drives it by itself, knowing the truth, so that what it "
               "senses depends on the seed only. Empty: it obeys cmd_vel.")
          .add("robot", &P::robot,
               "URDF file of the robot; empty: the text in the parameter robot_description.")
          .add("faults", &P::faults,
               "Fault file: what goes wrong and when (see config/worlds/README.md); empty: "
               "nothing, unless inject_fault asks for it.")
          .add("laser_frame", &P::laser_frame,
               "The link of the URDF that is the lidar; frame of `scan`.")
          .add("start", &P::start,
               "Where the robot starts, in the world; empty: at the start of the world file.")
          .rule(&P::start, "[x, y, yaw] or empty",
                [](const P& p) { return p.start.empty() || p.start.size() == 3; });
  return table;
}

const ram_parameters::ParameterTable<LockStepParameters>& LockStepParameters::table() {
  using namespace ram_parameters;
  using P = LockStepParameters;
  static const auto table =
      ParameterTable<P>()
          .add("topics", &P::topics,
               "After each scan, wait until a message of the scan's stamp or later came on each "
               "of these topics (any type that begins with a header). Empty: never wait.")
          .add("timeout_s", &P::timeout_s, "s", aboveUpTo(0.0, 3600.0),
               "Wall time after which the simulation continues without an answer; before the first "
               "answer at most 0.5 s.")
          .add("start_timeout_s", &P::start_timeout_s, "s", within(0.0, 3600.0),
               "Wall time to wait at the start for the lock step's partners to connect.")
          .expert("Lock step")
          .add("first_answer_s", &P::first_answer_s, "s", positive(),
               "Longest wait for the first answer: while partners are starting, a scan may have "
               "reached none of them.")
          .add("poll_s", &P::poll_s, "s", positive(),
               "How often a wait checks whether ROS is shutting down.");
  return table;
}

const ram_parameters::ParameterTable<TopicParameters>& TopicParameters::table() {
  using namespace ram_parameters;
  using P = TopicParameters;
  static const auto table =
      ParameterTable<P>()
          .add("queue_length", &P::queue_length, "", within(1, 100000),
               "Messages that wait on each topic.")
          .add("progress_step", &P::progress_step, "", positive(),
               "Share of a tour after which tour_progress is published again.")
          .add("rival_command_s", &P::rival_command_s, "s", atLeast(0.0),
               "Commands of two nodes on cmd_vel within this time are warned of.");
  return table;
}

const ram_parameters::ParameterTable<SimulatorNodeParameters>& SimulatorNodeParameters::table() {
  using namespace ram_parameters;
  using P = SimulatorNodeParameters;
  static const auto table =
      ParameterTable<P>()
          .add("world", &P::world,
               "World file, map_server map, mesh, URDF or SDF (see config/worlds/README.md); "
               "empty: an endless floor without walls.")
          .include(&P::every_robot, RobotParameters::table())
          .add("robots", &P::robot_names,
               "Several robots: their names, which become the namespace of their topics and the "
               "prefix of their frames; empty: one robot without either. Each has a section of "
               "its name, in which start, tour, robot, faults and laser_frame override the above, "
               "for robots: [alpha, beta] the sections alpha: {start: [1, 6, 0]} and beta: "
               "{start: [5, 6, 3.1]}.")
          .add("real_time_factor", &P::real_time_factor, "", within(0.0, 1000.0),
               "Simulated seconds per second; 0: as fast as possible.")
          .add("clock_rate_hz", &P::clock_rate_hz, "1/s", positive(),
               "Rate of /clock in simulated time.")
          .rule(&P::clock_rate_hz, "<= physics_rate_hz",
                [](const P& p) { return p.clock_rate_hz <= p.simulation.physics_rate_hz; })
          .include(&P::lock_step, LockStepParameters::table(), "lock_step_")
          .include(&P::simulation, SimulationParameters::table())
          .expert("Robots that are accepted")
          .section("robot_limits", &P::robot_limits, RobotLimits::table())
          .expert("Node")
          .add("max_step_s", &P::max_step_s, "s", positive(),
               "Longest that the service `step` runs.")
          .add("late_s", &P::late_s, "s", positive(),
               "A simulation that is later than this does not hurry to catch up.")
          .include(&P::topics, TopicParameters::table());
  return table;
}

void SimulatorNodeParameters::validate() const {
  static const std::regex name_pattern("[A-Za-z][A-Za-z0-9_]*");
  table().check(*this);
  std::set<std::string> names;
  for (const RobotParameters& robot : robots) {
    RobotParameters::table().check(robot);
    if (!robot.name.empty() && !std::regex_match(robot.name, name_pattern))
      throw std::invalid_argument("robots: '" + robot.name + "' is no name for a robot");
    if (!names.insert(robot.name).second)
      throw std::invalid_argument("robots: there are two called '" + robot.name + "'");
  }
}

SimulatorNodeParameters readSimulatorNodeParameters(ram_parameters::ParameterReader& reader) {
  SimulatorNodeParameters p;
  p.simulation = readSimulationParameters(reader);
  SimulatorNodeParameters::table().read(reader, p);
  p.robots.clear();
  for (const std::string& name : p.robot_names) {
    RobotParameters robot = p.every_robot;
    robot.name = name;
    ram_parameters::ParameterReader section = reader.section(name);
    RobotParameters::table().read(section, robot);
    section.rejectUnknown();
    p.robots.push_back(robot);
  }
  if (p.robots.empty()) p.robots.push_back(p.every_robot);
  reader.rejectUnknown();
  p.validate();
  return p;
}

std::vector<ram_parameters::ParameterFile> parameterFiles() {
  return {{"simulator.yaml", "ramscout_sim/simulator",
           "A robot with wheels and a lidar among walls. SI units, radians.",
           SimulatorNodeParameters::table().rows()}};
}

}  // namespace ramscout_sim
