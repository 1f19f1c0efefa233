// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include <ramscout_sim/faults.hpp>

#include "ramscout_bringup/parameter_files.hpp"

namespace ramscout_bringup {

/// A simulated drive, what goes wrong on it, and how good the results must be. docs/scenarios.md
/// describes the file.
struct Scenario {
  std::string name;                     ///< of the file, without folder and suffix
  std::string world;                    ///< path of a world file
  std::string tour;                     ///< path of a tour file
  std::string robot = kReferenceRobot;  ///< as ParameterFiles takes it
  std::string lidar;                    ///< likewise
  std::string estimator = "fast_slam";
  /// The estimator that maps the drive before; `estimator` then localises in that map. Empty: no
  /// map is given.
  std::string map_by;
  /// By which omnidirectional robots turn their heading from the way.
  double heading_offset_rad = 0.0;
  double most_s = 1200.0;  ///< simulated time after which the drive ends, finished or not
  std::vector<ramscout_sim::Fault> faults;
  std::map<std::string, double> limits;  ///< by the name of the figure
};

/// What is measured of a drive.
struct FigureKind {
  const char* name;
  bool at_least;  ///< a limit is the least that is accepted; otherwise the most
};
const std::vector<FigureKind>& figureKinds();

/// Paths in the file are relative to its folder.
/// \throws std::runtime_error or std::invalid_argument naming file, key and reason
Scenario readScenario(const std::string& path);

/// One line for each limit that is broken. A figure that is not a number breaks its limit.
std::vector<std::string> brokenLimits(const Scenario& scenario,
                                      const std::map<std::string, double>& figures);

}  // namespace ramscout_bringup
