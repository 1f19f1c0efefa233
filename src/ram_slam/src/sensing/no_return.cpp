// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/sensing/no_return.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {
namespace {

constexpr float kLeastCodeM = 5.0F;  // no common lidar sees less far
// A no-return code is farther than all but stray readings; a sensor has a few of them close
// together, each exact, where a wall's readings scatter, and far commoner than the readings of any
// far wall.
constexpr float kCodeSpread = 0.01F;
constexpr double kLeastCodeShare = 1e-4;
constexpr double kLeastShareAmongCodes = 0.25;
constexpr double kMaxShareBeyondCode = 0.01;
constexpr double kCodeToReadingRatio = 5.0;

}  // namespace

float NoReturnDetector::limit_m(float code_m) {
  return (1.0F - kCodeSpread) * code_m;
}

void NoReturnDetector::add(const std::vector<float>& ranges_m) {
  reading_count_ += ranges_m.size();
  for (const float range_m : ranges_m) {
    if (range_m >= kLeastCodeM && std::isfinite(range_m))
      ++count_of_cm_[std::lround(range_m * 100.0F)];
  }
}

std::optional<float> NoReturnDetector::code_m() const {
  const auto distance_seen = [](const auto& a, const auto& b) {
    return static_cast<double>(a.first) * static_cast<double>(a.second) <
           static_cast<double>(b.first) * static_cast<double>(b.second);
  };
  const auto code = std::max_element(count_of_cm_.begin(), count_of_cm_.end(), distance_seen);
  if (code == count_of_cm_.end()) return std::nullopt;

  const auto code_cm = static_cast<double>(code->first);
  const auto count = static_cast<double>(code->second);
  double among_codes = 0.0;
  double beyond_codes = 0.0;
  double most_beside = 0.0;
  for (auto other = count_of_cm_.lower_bound(code->first / 2); other != count_of_cm_.end();
       ++other) {
    const auto other_count = static_cast<double>(other->second);
    if (std::abs(static_cast<double>(other->first) - code_cm) <= kCodeSpread * code_cm) {
      among_codes += other_count;
    } else {
      most_beside = std::max(most_beside, other_count);
      if (other->first > code->first) beyond_codes += other_count;
    }
  }
  const bool is_exact = count >= kLeastShareAmongCodes * among_codes;
  const bool is_farthest = beyond_codes <= kMaxShareBeyondCode * count;
  const bool is_common = count >= std::max(kLeastCodeShare * static_cast<double>(reading_count_),
                                           kCodeToReadingRatio * most_beside);
  if (!is_exact || !is_farthest || !is_common) return std::nullopt;
  return static_cast<float>(code_cm / 100.0);
}

}  // namespace ram_slam
