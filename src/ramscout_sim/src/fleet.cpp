// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/fleet.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace ramscout_sim {
Fleet::Fleet(const std::vector<FleetMember>& members, const World& world) {
  if (members.empty()) throw std::invalid_argument("a fleet needs a robot");
  period_ns_ = std::llround(members.front().parameters.actors.period_s * 1e9);
  for (const FleetMember& member : members) {
    World own = world;
    own.start = member.start;
    robots_.emplace_back(member.parameters, member.robot, own, member.tour);
    for (const Fault& fault : member.faults) robots_.back().inject(fault);
  }
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Footprint a = robots_[i].footprint();
      const Footprint b = robots_[j].footprint();
      if ((a.center_m - b.center_m).norm() < a.radius_m + b.radius_m) {
        throw std::invalid_argument("robots " + std::to_string(j) + " and " + std::to_string(i) +
                                    " start within each other");
      }
    }
  }
  introduce();
}

std::vector<Outputs> Fleet::step() {
  if (now_ns() >= introduced_ns_ + period_ns_) introduce();
  std::vector<Outputs> outputs;
  outputs.reserve(robots_.size());
  for (Simulation& robot : robots_) outputs.push_back(robot.step());
  return outputs;
}

/// Shows each robot where the others are.
void Fleet::introduce() {
  introduced_ns_ = now_ns();
  if (robots_.size() == 1) return;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    std::vector<Solid> shapes;
    std::vector<Footprint> footprints;
    for (std::size_t j = 0; j < robots_.size(); ++j) {
      if (j == i) continue;
      const std::vector<Solid> own = robots_[j].chassis();
      shapes.insert(shapes.end(), own.begin(), own.end());
      footprints.push_back(robots_[j].footprint());
    }
    robots_[i].setOthers(std::move(shapes), std::move(footprints));
  }
}

}  // namespace ramscout_sim
