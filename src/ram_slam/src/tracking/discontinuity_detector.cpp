// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/discontinuity_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ram_slam {
namespace {

constexpr std::int64_t kViewEveryNs = 90'000'000;
constexpr std::int64_t kOldestReferenceNs = 1'000'000'000;
constexpr std::int64_t kNewestReferenceNs = 450'000'000;
constexpr std::int64_t kContradictingForNs = 200'000'000;
// A smaller contradiction makes suspicious: then less evidence from the map is needed for a while.
constexpr double kSuspicious = 0.25;
// That much is enough if it came from one view to the next: people need longer to change as much.
constexpr double kSharp = 0.5;
constexpr std::int64_t kSuspiciousForNs = 2'000'000'000;
// Of a disturbance that is over.
constexpr double kAgreeingShare = 0.03;
constexpr std::int64_t kAgreeingForNs = 300'000'000;
constexpr double kDisturbedWithin_m = 1.0;
constexpr double kDisturbedWithin_rad = 0.5;

}  // namespace

std::optional<double> discontinuity(const TrackedView& before, const TrackedView& now) {
  return discontinuity(*before.view, *now.view,
                       before.local_from_base.inverse() * now.local_from_base);
}

DiscontinuityDetector::Finding DiscontinuityDetector::compare(const TrackedView& now) {
  if (now.view == nullptr) return Finding::kNothing;
  const std::optional<double> share = leastContradiction(now);
  if (!share || *share <= kSuspicious * threshold_) {
    contradicting_since_ns_ = 0;
    return Finding::kNothing;
  }
  if (contradicting_since_ns_ == 0) {
    contradicting_since_ns_ = now.stamp_ns;
    contradicts_at_once_ = contradictsViewBefore(now);
  }
  if (now.stamp_ns < contradicting_since_ns_ + kContradictingForNs) return Finding::kNothing;
  if (*share > (contradicts_at_once_ ? kSharp : 1.0) * threshold_) return Finding::kCarriedAway;
  const bool was_suspicious = suspicious(now.stamp_ns);
  suspicious_until_ns_ = now.stamp_ns + kSuspiciousForNs;
  return was_suspicious ? Finding::kNothing : Finding::kSuspicious;
}

std::optional<double> DiscontinuityDetector::leastContradiction(const TrackedView& now) const {
  std::optional<double> least;
  for (const TrackedView& then : views_) {
    if (then.stamp_ns > now.stamp_ns - kNewestReferenceNs) break;
    if (then.stamp_ns < now.stamp_ns - kOldestReferenceNs) continue;
    const auto share = discontinuity(then, now);
    if (share) least = std::min(*share, least.value_or(1.0));
    if (least && *least <= kSuspicious * threshold_) break;
  }
  return least;
}

bool DiscontinuityDetector::contradictsViewBefore(const TrackedView& now) const {
  if (views_.empty()) return false;
  const auto share = discontinuity(views_.back(), now);
  return share && *share > kSharp * threshold_;
}

void DiscontinuityDetector::add(TrackedView view) {
  if (view.view == nullptr) return;
  if (!views_.empty() && view.stamp_ns < views_.back().stamp_ns + kViewEveryNs) return;
  while (!views_.empty() && views_.front().stamp_ns < view.stamp_ns - kOldestReferenceNs)
    views_.pop_front();
  views_.push_back(std::move(view));
}

void DiscontinuityDetector::clear() {
  views_.clear();
  contradicting_since_ns_ = 0;
  suspicious_until_ns_ = 0;
}

void DisturbanceDetector::start(std::optional<TrackedView> before, std::int64_t now_ns) {
  before_ = std::move(before);
  agreeing_since_ns_ = now_ns;
}

bool DisturbanceDetector::isOver(const TrackedView& now) {
  if (!before_ || now.view == nullptr) return false;
  const Pose2 moved = before_->local_from_base.inverse() * now.local_from_base;
  if (moved.translation().norm() > kDisturbedWithin_m ||
      std::abs(moved.yaw_rad) > kDisturbedWithin_rad) {
    before_.reset();
    return false;
  }
  const auto share = discontinuity(*before_, now);
  if (!share || *share > kAgreeingShare) agreeing_since_ns_ = now.stamp_ns;
  return now.stamp_ns >= agreeing_since_ns_ + kAgreeingForNs;
}

}  // namespace ram_slam
