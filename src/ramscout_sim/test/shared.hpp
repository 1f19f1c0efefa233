// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ramscout_sim/robot_description.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim::testing {

/// The robot that the repository ships.
inline RobotDescription shippedRobot() {
  return readRobot(std::string(CONFIG_FOLDER) + "/robots/ramscout.urdf");
}

/// Four walls whose inner faces are at x = 0 and `length_m`, y = 0 and `width_m`; the robot starts
/// in the middle.
inline World makeRoom(double length_m, double width_m) {
  constexpr double kThickness_m = 0.2;
  constexpr double kHeight_m = 2.5;
  const double low = -0.5 * kThickness_m;
  const double right = length_m - low;
  const double top = width_m - low;
  World room;
  room.solids = {makeWall({2 * low, low}, {right - low, low}, kThickness_m, kHeight_m),
                 makeWall({2 * low, top}, {right - low, top}, kThickness_m, kHeight_m),
                 makeWall({low, 2 * low}, {low, top - low}, kThickness_m, kHeight_m),
                 makeWall({right, 2 * low}, {right, top - low}, kThickness_m, kHeight_m)};
  room.start = {0.5 * length_m, 0.5 * width_m, 0.0};
  return room;
}

}  // namespace ramscout_sim::testing
