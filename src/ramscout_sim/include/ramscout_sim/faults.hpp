// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "ramscout_sim/pose2.hpp"

namespace ramscout_sim {

/// Something that goes wrong on command; InjectFault.srv states what each means.
enum class FaultKind {
  kScanDropout,
  kScanSector,
  kClockOffset,
  kLidarTilt,
  kLeftEncoderDead,
  kRightEncoderDead,
  kWheelSlip,
  kLeftWheelSlip,
  kRightWheelSlip,
  kLeftWheelBlocked,
  kRightWheelBlocked,
  kFloorFriction,
  kMotorsDead,
  kPush,
  kShove,
  kPayload,
  kKidnap,
  kLift,
  kOdometryReset,
  kDoor,
  kPerson,
};

struct Fault {
  FaultKind kind = FaultKind::kScanDropout;
  double start_s = 0.0;  ///< simulated time since the start of the simulation
  double duration_s = 1.0;
  double amount = 0.0;         ///< what it counts depends on the kind
  double angle_min_rad = 0.0;  ///< of a masked sector
  double angle_max_rad = 0.0;
  /// In the world: where a robot is put, where a person appears; in the base frame: where a payload
  /// lies.
  Pose2 pose;
  std::string target;  ///< the door's name

  /// \throws std::invalid_argument naming the field, its value and the bound it breaks
  void validate() const;
};

/// The kind's name as in InjectFault.srv, and back. \throws std::invalid_argument for any other
/// name
std::string toString(FaultKind kind);
FaultKind parseFaultKind(const std::string& name);

/// The fault as an element of a fault file, on one line.
std::string toYaml(const Fault& fault);

/// Reads a YAML file with the list `faults`, each element with `kind`, `start_s` and, where they
/// matter, `duration_s`, `amount`, `angle_min_rad`, `angle_max_rad`, `pose`, `target`. \throws
/// std::runtime_error or std::invalid_argument naming file, element and reason
std::vector<Fault> readFaults(const std::string& path);

/// The same of such a list that is part of a file. \param source  the file, for errors
std::vector<Fault> readFaults(const YAML::Node& list, const std::string& source);

}  // namespace ramscout_sim
