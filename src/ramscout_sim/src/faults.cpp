// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/faults.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "ram_parameters/parameter_reader.hpp"

namespace ramscout_sim {
namespace {

constexpr std::array<std::pair<FaultKind, const char*>, 8> kNames = {{
    {FaultKind::kScanDropout, "scan_dropout"},
    {FaultKind::kScanSector, "scan_sector"},
    {FaultKind::kLeftEncoderDead, "left_encoder_dead"},
    {FaultKind::kRightEncoderDead, "right_encoder_dead"},
    {FaultKind::kWheelSlip, "wheel_slip"},
    {FaultKind::kMotorsDead, "motors_dead"},
    {FaultKind::kPush, "push"},
    {FaultKind::kOdometryReset, "odometry_reset"},
}};

void require(bool condition, const char* field, double value, const char* bound) {
  if (!condition) {
    throw std::invalid_argument(std::string(field) + " must be " + bound + ", got " +
                                std::to_string(value));
  }
}

}  // namespace

void Fault::validate() const {
  require(start_s >= 0.0 && start_s <= 1e6, "start", start_s, "in [0, 1e6] s");
  const bool at_once = kind == FaultKind::kPush || kind == FaultKind::kOdometryReset;
  require(at_once || (duration_s > 0.0 && duration_s <= 3600.0), "duration", duration_s,
          "in (0, 3600] s");
  require(std::abs(amount) <= 10.0, "amount", amount, "in [-10, 10]");
  if (kind != FaultKind::kScanSector) return;
  require(std::abs(angle_min_rad) <= 2.0 * M_PI, "angle_min", angle_min_rad, "within a turn");
  require(std::abs(angle_max_rad) <= 2.0 * M_PI && angle_max_rad > angle_min_rad, "angle_max",
          angle_max_rad, "above angle_min and within a turn");
}

std::string toString(FaultKind kind) {
  for (const auto& [known, name] : kNames) {
    if (known == kind) return name;
  }
  throw std::logic_error("unknown kind of fault");
}

FaultKind parseFaultKind(const std::string& name) {
  std::string known_names;
  for (const auto& [kind, known] : kNames) {
    if (name == known) return kind;
    known_names += std::string(known_names.empty() ? "" : ", ") + known;
  }
  throw std::invalid_argument("kind must be one of " + known_names + ", got '" + name + "'");
}

std::vector<Fault> readFaults(const std::string& path) {
  const YAML::Node file = ram_parameters::readYamlFile(path);
  ram_parameters::ParameterReader top(file, path);
  top.has("faults");
  top.rejectUnknown();
  const YAML::Node list = file["faults"];
  if (!list || !list.IsSequence()) throw std::invalid_argument(path + ": faults: must be a list");
  std::vector<Fault> faults;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string name = path + ": faults[" + std::to_string(i) + "]";
    ram_parameters::ParameterReader reader(list[i], name);
    std::string kind;
    Fault fault;
    reader.read("kind", kind);
    reader.read("start_s", fault.start_s);
    reader.read("duration_s", fault.duration_s);
    reader.read("amount", fault.amount);
    reader.read("angle_min_rad", fault.angle_min_rad);
    reader.read("angle_max_rad", fault.angle_max_rad);
    reader.rejectUnknown();
    try {
      fault.kind = parseFaultKind(kind);
      fault.validate();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(name + ": " + error.what());
    }
    faults.push_back(fault);
  }
  return faults;
}

}  // namespace ramscout_sim
