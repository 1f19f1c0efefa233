// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/geometry/trajectory.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {
namespace {

/// Odometry that moves farther than this within a second has jumped: no robot indoors is as fast.
constexpr MotionGate kMostPerSecond{5.0, 5.0};

bool isJump(const StampedPose2& before, const StampedPose2& after) {
  const double interval_s = 1e-9 * static_cast<double>(after.stamp_ns - before.stamp_ns);
  const MotionGate most{kMostPerSecond.distance_m * interval_s,
                        kMostPerSecond.angle_rad * interval_s};
  return most.isExceededBy(before.pose.inverse() * after.pose);
}

/// The readings around a stamp; the same one twice at its own stamp.
template <typename Poses>
std::optional<std::pair<StampedPose2, StampedPose2>> posesAround(const Poses& poses,
                                                                 std::int64_t stamp_ns) {
  const auto after = std::lower_bound(
      poses.begin(), poses.end(), stamp_ns,
      [](const StampedPose2& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after == poses.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return std::pair(*after, *after);
  if (after == poses.begin()) return std::nullopt;
  return std::pair(*std::prev(after), *after);
}

Pose2 poseBetween(const StampedPose2& before, const StampedPose2& after, std::int64_t stamp_ns) {
  if (before.stamp_ns == after.stamp_ns) return before.pose;
  return interpolate(before.pose, after.pose,
                     static_cast<double>(stamp_ns - before.stamp_ns) /
                         static_cast<double>(after.stamp_ns - before.stamp_ns));
}

}  // namespace

void validate(const Trajectory& trajectory) {
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (trajectory[i].pose.isUsable() &&
        (i == 0 || trajectory[i].stamp_ns > trajectory[i - 1].stamp_ns))
      continue;
    throw std::invalid_argument(
        "trajectory has a pose that is not finite, farther off than 10,000 km, or not later than "
        "the one before it, at " +
        std::to_string(trajectory[i].stamp_ns) + " ns");
  }
}

Trajectory withAtMost(Trajectory trajectory, std::size_t most) {
  if (trajectory.size() <= most) return trajectory;
  const std::size_t newest = most - most / 2;
  const std::size_t older = trajectory.size() - newest;
  const std::size_t stride = (older + most / 2 - 1) / (most / 2);
  Trajectory kept;
  kept.reserve(most);
  for (std::size_t i = 0; i < older; i += stride) kept.push_back(trajectory[i]);
  kept.insert(kept.end(), trajectory.end() - static_cast<std::ptrdiff_t>(newest), trajectory.end());
  return kept;
}

std::optional<Pose2> poseAt(const Trajectory& trajectory, std::int64_t stamp_ns) {
  const auto around = posesAround(trajectory, stamp_ns);
  if (!around) return std::nullopt;
  return poseBetween(around->first, around->second, stamp_ns);
}

std::optional<Pose2> odometryAt(const std::deque<StampedPose2>& readings, std::int64_t stamp_ns) {
  const auto around = posesAround(readings, stamp_ns);
  if (!around) return std::nullopt;
  const auto& [before, after] = *around;
  if (isJump(before, after)) {
    return stamp_ns - before.stamp_ns <= after.stamp_ns - stamp_ns ? before.pose : after.pose;
  }
  return poseBetween(before, after, stamp_ns);
}

}  // namespace ram_slam
