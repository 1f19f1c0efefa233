// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/mirror_check.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {

void MirrorCheck::add(const LaserScan& scan, double odom_yaw_rad) {
  const double turn_rad = std::remainder(odom_yaw_rad - last_yaw_rad_, 2.0 * M_PI);
  if (!last_.ranges_m.empty() && std::abs(turn_rad) < kLeastTurn_rad) return;
  if (!last_.ranges_m.empty() && std::abs(turn_rad) < kMostTurn_rad) {
    const auto with = difference_m(scan, turn_rad);
    const auto against = difference_m(scan, -turn_rad);
    if (with && against) {
      with_wheels_m_ = kMemory * with_wheels_m_ + *with;
      against_wheels_m_ = kMemory * against_wheels_m_ + *against;
      turned_rad_ = kMemory * turned_rad_ + std::abs(turn_rad);
    }
  }
  last_ = scan;
  last_yaw_rad_ = odom_yaw_rad;
  if (turned_rad_ < kLeastSum_rad) return;
  if (with_wheels_m_ > kClearRatio * against_wheels_m_) is_mirrored_ = true;
  if (against_wheels_m_ > kClearRatio * with_wheels_m_) is_mirrored_ = false;
}

std::optional<double> MirrorCheck::difference_m(const LaserScan& scan, double turn_rad) const {
  double sum_m = 0.0;
  int count = 0;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    // What the laser sees at a bearing now it saw at that plus its turn before.
    const double place =
        (scan.bearing_rad(beam) + turn_rad - last_.angle_min_rad) / last_.angle_increment_rad;
    const double whole = 2.0 * M_PI / std::abs(last_.angle_increment_rad);
    const double beams = static_cast<double>(last_.ranges_m.size());
    const double wrapped = place < 0.0 ? place + whole : place >= beams ? place - whole : place;
    const auto before = static_cast<std::size_t>(std::max(0.0, std::round(wrapped)));
    if (wrapped < 0.0 || before >= last_.ranges_m.size()) continue;
    if (scan.at(beam) != Return::kHit || last_.at(before) != Return::kHit) continue;
    const double range_m = static_cast<double>(scan.ranges_m[beam]);
    if (range_m > kMostRange_m) continue;
    const double off_m = std::abs(range_m - static_cast<double>(last_.ranges_m[before]));
    sum_m += std::min(off_m, kLimit_m);
    ++count;
  }
  if (count < kLeastBeams) return std::nullopt;
  return sum_m / count;
}

}  // namespace ram_slam
