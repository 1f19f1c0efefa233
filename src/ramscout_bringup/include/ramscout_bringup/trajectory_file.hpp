// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_slam/geometry/trajectory.hpp"

namespace ramscout_bringup {

using ram_slam::Trajectory;

/// Reads a trajectory in the TUM format, plain or packed (.gz, .xz): lines `stamp x y z qx qy qz
/// qw` [s, m]; `#` starts a comment. The planar part is kept, the poses sorted by stamp. Stamps are
/// read digit by digit: exact to 1 ns. \throws std::runtime_error naming file and line if a line is
/// malformed, or the file if it has no pose or does not lie in the x-y plane
Trajectory readTrajectory(const std::string& path);

/// The trajectory as text in the TUM format: stamps with nine decimals, positions to 1 um,
/// quaternions to 1e-9.
std::string toTum(const Trajectory& trajectory);

}  // namespace ramscout_bringup
