// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ramscout_sim/simulation.hpp"

namespace ramscout_sim {

/// One robot of a fleet.
struct FleetMember {
  SimulationParameters parameters;
  RobotDescription robot;
  std::optional<Tour> tour;
  std::vector<Fault> faults;
  Pose2 start;
};

/// Robots in one world, stepped together. Their lidars see each other's chassis; a robot that
/// drives into another meets a wall and pushes nothing. People stop and doors wait for all of them.
/// Same inputs, same outputs, bit by bit.
class Fleet {
public:
  /// \throws std::invalid_argument as Simulation, or if two robots start within each other
  Fleet(const std::vector<FleetMember>& members, const World& world);

  std::size_t size() const { return robots_.size(); }
  Simulation& operator[](std::size_t index) { return robots_[index]; }
  const Simulation& operator[](std::size_t index) const { return robots_[index]; }
  std::int64_t now_ns() const { return robots_.front().now_ns(); }

  /// Advances all robots by one physics step. \return one per robot
  std::vector<Outputs> step();

private:
  void introduce();

  std::vector<Simulation> robots_;
  std::int64_t period_ns_ = 0;  // how often robots notice where the others are
  std::int64_t introduced_ns_ = 0;
};

}  // namespace ramscout_sim
