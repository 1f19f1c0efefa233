// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/faults.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_parameters/require.hpp"
#include "ramscout_sim/robot_description.hpp"

namespace ramscout_sim {
namespace {

/// What the fields of a fault may be.
struct Rule {
  FaultKind kind;
  const char* name;
  bool at_once;
  double least_amount;
  double largest_amount;
  const char* amount_bound;
};

const std::array<Rule, 21> kRules = {{
    {FaultKind::kScanDropout, "scan_dropout", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kScanSector, "scan_sector", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kClockOffset, "clock_offset", false, -10.0, 10.0, "in [-10, 10] s"},
    {FaultKind::kLidarTilt, "lidar_tilt", false, -1.0, 1.0, "in [-1, 1] rad"},
    {FaultKind::kLeftEncoderDead, "left_encoder_dead", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kRightEncoderDead, "right_encoder_dead", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kWheelSlip, "wheel_slip", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kLeftWheelSlip, "left_wheel_slip", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kRightWheelSlip, "right_wheel_slip", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kLeftWheelBlocked, "left_wheel_blocked", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kRightWheelBlocked, "right_wheel_blocked", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kFloorFriction, "floor_friction", false, 0.0, 10.0, "in [0, 10]"},
    {FaultKind::kMotorsDead, "motors_dead", false, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kPush, "push", true, -10.0, 10.0, "in [-10, 10] m"},
    {FaultKind::kShove, "shove", false, -std::numeric_limits<double>::max(),
     std::numeric_limits<double>::max(), "finite"},
    {FaultKind::kPayload, "payload", false, 0.0, 1000.0, "in [0, 1000] kg"},
    {FaultKind::kKidnap, "kidnap", true, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kLift, "lift", false, 0.0, 3.0, "in [0, 3] m"},
    {FaultKind::kOdometryReset, "odometry_reset", true, -10.0, 10.0, "in [-10, 10]"},
    {FaultKind::kDoor, "door", true, 0.0, 1.0, "in [0, 1]"},
    {FaultKind::kPerson, "person", false, 0.0, 10.0, "in [0, 10] m/s"},
}};

const Rule& ruleOf(FaultKind kind) {
  for (const Rule& rule : kRules) {
    if (rule.kind == kind) return rule;
  }
  throw std::logic_error("unknown kind of fault");
}

using ram_parameters::require;

Fault readFault(ram_parameters::ParameterReader& reader, const std::string& name) {
  std::string kind;
  std::vector<double> pose = {0.0, 0.0, 0.0};
  Fault fault;
  reader.read("kind", kind);
  reader.read("start_s", fault.start_s);
  reader.read("duration_s", fault.duration_s);
  reader.read("amount", fault.amount);
  reader.read("angle_min_rad", fault.angle_min_rad);
  reader.read("angle_max_rad", fault.angle_max_rad);
  reader.read("pose", pose);
  reader.read("target", fault.target);
  reader.rejectUnknown();
  try {
    if (pose.size() != 3) throw std::invalid_argument("pose must be [x, y, yaw]");
    fault.pose = {pose[0], pose[1], pose[2]};
    fault.kind = parseFaultKind(kind);
    fault.validate();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(name + ": " + error.what());
  }
  return fault;
}

}  // namespace

void Fault::validate() const {
  const Rule& rule = ruleOf(kind);
  require(start_s >= 0.0 && start_s <= 1e6, "start", start_s, "in [0, 1e6] s");
  require(rule.at_once || (duration_s > 0.0 && duration_s <= 3600.0), "duration", duration_s,
          "in (0, 3600] s");
  require(amount >= rule.least_amount && amount <= rule.largest_amount, "amount", amount,
          rule.amount_bound);
  for (const double coordinate : {pose.x_m, pose.y_m, pose.yaw_rad})
    require(std::abs(coordinate) <= kLargestCoordinate_m, "pose", coordinate,
            "finite and within 100 km");
  const double largest_robot_m = RobotLimits().max_size_m;
  require(kind != FaultKind::kPayload || std::hypot(pose.x_m, pose.y_m) <= largest_robot_m, "pose",
          std::hypot(pose.x_m, pose.y_m), "on the robot, within 5 m of its base frame");
  if (kind == FaultKind::kDoor && target.empty())
    throw std::invalid_argument("target must name a door");
  if (kind != FaultKind::kScanSector) return;
  require(std::abs(angle_min_rad) <= 2.0 * M_PI, "angle_min", angle_min_rad, "within a turn");
  require(std::abs(angle_max_rad) <= 2.0 * M_PI && angle_max_rad > angle_min_rad, "angle_max",
          angle_max_rad, "above angle_min and within a turn");
}

std::string toString(FaultKind kind) {
  return ruleOf(kind).name;
}

FaultKind parseFaultKind(const std::string& name) {
  std::string known_names;
  for (const Rule& rule : kRules) {
    if (name == rule.name) return rule.kind;
    known_names += std::string(known_names.empty() ? "" : ", ") + rule.name;
  }
  throw std::invalid_argument("kind must be one of " + known_names + ", got '" + name + "'");
}

std::string toYaml(const Fault& fault) {
  const Fault plain;
  std::ostringstream text;
  text.precision(9);
  text << "{kind: " << toString(fault.kind) << ", start_s: " << fault.start_s;
  if (!ruleOf(fault.kind).at_once) text << ", duration_s: " << fault.duration_s;
  if (fault.amount != plain.amount) text << ", amount: " << fault.amount;
  if (fault.kind == FaultKind::kScanSector) {
    text << ", angle_min_rad: " << fault.angle_min_rad
         << ", angle_max_rad: " << fault.angle_max_rad;
  }
  if (fault.pose.x_m != 0.0 || fault.pose.y_m != 0.0 || fault.pose.yaw_rad != 0.0) {
    text << ", pose: [" << fault.pose.x_m << ", " << fault.pose.y_m << ", " << fault.pose.yaw_rad
         << "]";
  }
  if (!fault.target.empty()) text << ", target: " << YAML::Dump(YAML::Node(fault.target));
  return text.str() + "}";
}

std::vector<Fault> readFaults(const std::string& path) {
  const YAML::Node file = ram_parameters::readYamlFile(path);
  ram_parameters::ParameterReader top(file, path);
  top.has("faults");
  top.rejectUnknown();
  return readFaults(file["faults"], path);
}

std::vector<Fault> readFaults(const YAML::Node& list, const std::string& source) {
  if (!list || !list.IsSequence()) throw std::invalid_argument(source + ": faults: must be a list");
  std::vector<Fault> faults;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string name = source + ": faults[" + std::to_string(i) + "]";
    ram_parameters::ParameterReader reader(list[i], name);
    faults.push_back(readFault(reader, name));
  }
  return faults;
}

}  // namespace ramscout_sim
