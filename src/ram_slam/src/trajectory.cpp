// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/trajectory.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace ram_slam {

void validate(const Trajectory& trajectory) {
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (trajectory[i].pose.isFinite() &&
        (i == 0 || trajectory[i].stamp_ns > trajectory[i - 1].stamp_ns))
      continue;
    throw std::invalid_argument(
        "trajectory has a pose that is not finite or not later than the one before it, at " +
        std::to_string(trajectory[i].stamp_ns) + " ns");
  }
}

std::optional<Pose2> poseAt(const Trajectory& trajectory, std::int64_t stamp_ns) {
  const auto after = std::lower_bound(
      trajectory.begin(), trajectory.end(), stamp_ns,
      [](const StampedPose2& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return after->pose;
  if (after == trajectory.begin()) return std::nullopt;
  const StampedPose2& before = *(after - 1);
  const double fraction = static_cast<double>(stamp_ns - before.stamp_ns) /
                          static_cast<double>(after->stamp_ns - before.stamp_ns);
  return interpolate(before.pose, after->pose, fraction);
}

}  // namespace ram_slam
