// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {

/// Poses in the order of their stamps, which strictly increase.
using Trajectory = std::vector<StampedPose2>;

/// \throws std::invalid_argument naming the stamp where a pose is not finite or the stamps do not
/// increase
void validate(const Trajectory& trajectory);

/// At most so many poses of a trajectory: the newest half of them as they are, of the older ones
/// the first and every n-th. \param most  at least 2
Trajectory withAtMost(Trajectory trajectory, std::size_t most);

/// The pose at a stamp, interpolated at constant twist between its neighbours; nothing outside the
/// trajectory.
std::optional<Pose2> poseAt(const Trajectory& trajectory, std::int64_t stamp_ns);

/// Likewise of the newest readings of an odometry. Between two readings that no robot can drive
/// through (more than 5 m/s or 5 rad/s: it was reset, or the log is not whole) there is no pose:
/// the nearer one counts.
std::optional<Pose2> odometryAt(const std::deque<StampedPose2>& readings, std::int64_t stamp_ns);

}  // namespace ram_slam
