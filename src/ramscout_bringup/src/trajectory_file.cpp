// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/trajectory_file.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "ramscout_bringup/text_file.hpp"
#include "ramscout_bringup/words.hpp"

namespace ramscout_bringup {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1000000000;

/// More is no robot on a floor or a ramp, but a trajectory in other axes.
constexpr double kMaxTiltRad = 0.5;
/// Likewise: rise and fall of the path, in parts of its extent in the plane, beyond a storey.
constexpr double kMaxSteepness = 0.5;
constexpr double kStoreyM = 1.0;

/// What the file has beyond the plane.
struct Height {
  double lowest_m = std::numeric_limits<double>::infinity();
  double highest_m = -std::numeric_limits<double>::infinity();
  double tilt_rad = 0.0;
};

std::optional<ram_slam::StampedPose2> toPose(std::string_view line, Height& height) {
  Words words(line);
  const std::int64_t stamp_ns = words.stampNs();
  std::array<double, 7> v{};  // x y z qx qy qz qw
  for (double& value : v) value = words.number<double>();
  const double yaw_rad =
      std::atan2(2.0 * (v[6] * v[5] + v[3] * v[4]), 1.0 - 2.0 * (v[4] * v[4] + v[5] * v[5]));
  const ram_slam::Pose2 pose{v[0], v[1], yaw_rad};
  if (!words.good() || stamp_ns < 0 || !pose.isFinite()) return std::nullopt;
  const double up = 1.0 - 2.0 * (v[3] * v[3] + v[4] * v[4]);  // z of the turned z axis
  height.tilt_rad = std::max(height.tilt_rad, std::acos(std::clamp(up, -1.0, 1.0)));
  height.lowest_m = std::min(height.lowest_m, v[2]);
  height.highest_m = std::max(height.highest_m, v[2]);
  return ram_slam::StampedPose2{stamp_ns, pose};
}

/// \throws std::runtime_error unless the trajectory lies in the x-y plane
void requirePlanar(const Trajectory& trajectory, const Height& height, const std::string& path) {
  const auto [left, right] =
      std::minmax_element(trajectory.begin(), trajectory.end(),
                          [](const auto& a, const auto& b) { return a.pose.x_m < b.pose.x_m; });
  const auto [low, high] =
      std::minmax_element(trajectory.begin(), trajectory.end(),
                          [](const auto& a, const auto& b) { return a.pose.y_m < b.pose.y_m; });
  const double extent_m =
      std::hypot(right->pose.x_m - left->pose.x_m, high->pose.y_m - low->pose.y_m);
  const double rise_m = height.highest_m - height.lowest_m;
  if (height.tilt_rad <= kMaxTiltRad && rise_m <= std::max(kStoreyM, kMaxSteepness * extent_m))
    return;
  throw std::runtime_error(path + " does not lie in the x-y plane (tilted by up to " +
                           std::to_string(height.tilt_rad) + " rad, z over " +
                           std::to_string(rise_m) +
                           " m): turn it to the axes of REP 103, x ahead and z up");
}

}  // namespace

Trajectory readTrajectory(const std::string& path) {
  TextFile file(path);
  Trajectory trajectory;
  Height height;
  for (int number = 1; const auto line = file.nextLine(); ++number) {
    std::string_view content = line->substr(0, line->find('#'));
    if (content.find_first_not_of(" \t") == std::string_view::npos) continue;
    const auto pose = toPose(content, height);
    if (!pose) {
      throw std::runtime_error(path + ":" + std::to_string(number) +
                               ": wanted 'stamp x y z qx qy qz qw'");
    }
    trajectory.push_back(*pose);
  }
  if (trajectory.empty()) throw std::runtime_error(path + " has no pose");
  requirePlanar(trajectory, height, path);
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return trajectory;
}

std::string toTum(const Trajectory& trajectory) {
  std::string text;
  std::array<char, 160> line{};
  for (const ram_slam::StampedPose2& stamped : trajectory) {
    const int length = std::snprintf(
        line.data(), line.size(), "%" PRId64 ".%09" PRId64 " %.6f %.6f 0 0 0 %.9f %.9f\n",
        stamped.stamp_ns / kNanosecondsPerSecond, stamped.stamp_ns % kNanosecondsPerSecond,
        stamped.pose.x_m, stamped.pose.y_m, std::sin(stamped.pose.yaw_rad / 2.0),
        std::cos(stamped.pose.yaw_rad / 2.0));
    text.append(line.data(), static_cast<std::size_t>(length));
  }
  return text;
}

}  // namespace ramscout_bringup
