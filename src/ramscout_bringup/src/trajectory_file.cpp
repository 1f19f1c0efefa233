// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/trajectory_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "ramscout_bringup/text_file.hpp"

namespace ramscout_bringup {
namespace {

constexpr int kStampDecimals = 9;
constexpr std::int64_t kNanosecondsPerSecond = 1000000000;

std::string_view nextWord(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
  const std::size_t length = std::min(rest.find_first_of(" \t"), rest.size());
  const std::string_view word = rest.substr(0, length);
  rest.remove_prefix(length);
  return word;
}

template <typename Number>
std::optional<Number> toNumber(std::string_view word) {
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

/// Decimal seconds to nanoseconds without passing through a double, which resolves 0.2 us at
/// today's epoch.
std::optional<std::int64_t> toStampNs(std::string_view word) {
  const std::size_t point = std::min(word.find('.'), word.size());
  const auto seconds = toNumber<std::int64_t>(word.substr(0, point));
  if (!seconds || *seconds < 0) return std::nullopt;
  std::string decimals(point < word.size() ? word.substr(point + 1) : std::string_view());
  decimals.resize(kStampDecimals, '0');
  const auto nanoseconds = toNumber<std::int64_t>(decimals);
  if (!nanoseconds || *nanoseconds < 0) return std::nullopt;
  return *seconds * kNanosecondsPerSecond + *nanoseconds;
}

std::optional<ram_slam::StampedPose2> toPose(std::string_view line) {
  const auto stamp_ns = toStampNs(nextWord(line));
  if (!stamp_ns) return std::nullopt;
  std::array<double, 7> v{};  // x y z qx qy qz qw
  for (double& value : v) {
    const auto number = toNumber<double>(nextWord(line));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    value = *number;
  }
  const double yaw_rad =
      std::atan2(2.0 * (v[6] * v[5] + v[3] * v[4]), 1.0 - 2.0 * (v[4] * v[4] + v[5] * v[5]));
  return ram_slam::StampedPose2{*stamp_ns, {v[0], v[1], yaw_rad}};
}

}  // namespace

Trajectory readTrajectory(const std::string& path) {
  TextFile file(path);
  Trajectory trajectory;
  for (int number = 1; const auto line = file.nextLine(); ++number) {
    std::string_view content = line->substr(0, line->find('#'));
    if (content.find_first_not_of(" \t") == std::string_view::npos) continue;
    const auto pose = toPose(content);
    if (!pose) {
      throw std::runtime_error(path + ":" + std::to_string(number) +
                               ": wanted 'stamp x y z qx qy qz qw'");
    }
    trajectory.push_back(*pose);
  }
  if (trajectory.empty()) throw std::runtime_error(path + " has no pose");
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
