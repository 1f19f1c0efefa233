// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/discontinuity_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/tracking/duration.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<DiscontinuityParameters>& DiscontinuityParameters::table() {
  using P = DiscontinuityParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("view_period_s", &P::view_period_s, "s", atLeast(0.0),
               "Least time between two views that are kept to be compared with.")
          .add("oldest_reference_s", &P::oldest_reference_s, "s", positive(),
               "A view is compared with views at most this old ...")
          .add("newest_reference_s", &P::newest_reference_s, "s", atLeast(0.0),
               "... and at least this old.")
          .rule(&P::newest_reference_s, "<= oldest_reference_s",
                [](const P& p) { return p.newest_reference_s <= p.oldest_reference_s; })
          .add("contradicting_s", &P::contradicting_s, "s", atLeast(0.0),
               "All views have to contradict those before for so long.")
          .add("suspicious_share", &P::suspicious_share, "", within(0.0, 1.0),
               "A contradiction above this share of the threshold is suspicious: less evidence "
               "from the map is needed for a while.")
          .add("sharp_share", &P::sharp_share, "", within(0.0, 1.0),
               "This share of the threshold is enough if the contradiction came from one view to "
               "the next: people need longer to change as much.")
          .add("suspicious_s", &P::suspicious_s, "s", atLeast(0.0), "How long a suspicion lasts.");
  return table;
}

const ram_parameters::ParameterTable<DisturbanceParameters>& DisturbanceParameters::table() {
  using P = DisturbanceParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("agreeing_ratio", &P::agreeing_ratio, "", within(0.0, 1.0),
               "A disturbance is over when the view from before is contradicted in no more than "
               "this share ...")
          .add("agreeing_s", &P::agreeing_s, "s", atLeast(0.0), "... for so long ...")
          .add("range_m", &P::range_m, "m", atLeast(0.0),
               "... and the robot has not moved by more than this ...")
          .add("range_rad", &P::range_rad, "rad", atLeast(0.0), "... or turned by more than this.");
  return table;
}

std::optional<double> discontinuity(const TrackedView& before, const TrackedView& now) {
  return discontinuity(*before.view, *now.view,
                       before.local_from_base.inverse() * now.local_from_base);
}

DiscontinuityDetector::Finding DiscontinuityDetector::compare(const TrackedView& now) {
  if (now.view == nullptr) return Finding::kNothing;
  const std::optional<double> ratio = leastContradictionRatio(now);
  if (!ratio || *ratio <= parameters_.suspicious_share * threshold_ratio_) {
    contradicting_since_ns_ = 0;
    return Finding::kNothing;
  }
  if (contradicting_since_ns_ == 0) {
    contradicting_since_ns_ = now.stamp_ns;
    step_ratio_ = stepRatio(now);
  }
  if (now.stamp_ns < contradicting_since_ns_ + toNanoseconds(parameters_.contradicting_s))
    return Finding::kNothing;
  const double sharp_ratio = parameters_.sharp_share * threshold_ratio_;
  if (*ratio > (step_ratio_ > sharp_ratio ? sharp_ratio : threshold_ratio_))
    return Finding::kCarriedAway;
  const bool was_suspicious = suspicious(now.stamp_ns);
  suspicious_until_ns_ = now.stamp_ns + toNanoseconds(parameters_.suspicious_s);
  return was_suspicious ? Finding::kNothing : Finding::kSuspicious;
}

std::optional<double> DiscontinuityDetector::leastContradictionRatio(const TrackedView& now) const {
  const std::int64_t newest_ns = now.stamp_ns - toNanoseconds(parameters_.newest_reference_s);
  const std::int64_t oldest_ns = now.stamp_ns - toNanoseconds(parameters_.oldest_reference_s);
  std::optional<double> least;
  for (const TrackedView& then : views_) {
    if (then.stamp_ns > newest_ns) break;
    if (then.stamp_ns < oldest_ns) continue;
    const auto ratio = discontinuity(then, now);
    if (ratio) least = std::min(*ratio, least.value_or(1.0));
    if (least && *least <= parameters_.suspicious_share * threshold_ratio_) break;
  }
  return least;
}

double DiscontinuityDetector::stepRatio(const TrackedView& now) const {
  return views_.empty() ? 0.0 : discontinuity(views_.back(), now).value_or(0.0);
}

void DiscontinuityDetector::add(TrackedView view) {
  if (view.view == nullptr) return;
  if (!views_.empty() &&
      view.stamp_ns < views_.back().stamp_ns + toNanoseconds(parameters_.view_period_s))
    return;
  const std::int64_t oldest_ns = view.stamp_ns - toNanoseconds(parameters_.oldest_reference_s);
  while (!views_.empty() && views_.front().stamp_ns < oldest_ns) views_.pop_front();
  views_.push_back(std::move(view));
}

void DiscontinuityDetector::clear() {
  views_.clear();
  contradicting_since_ns_ = 0;
  suspicious_until_ns_ = 0;
}

bool DisturbanceDetector::isOver(const TrackedView& now) {
  if (!before_ || now.view == nullptr) return false;
  const Pose2 moved = before_->local_from_base.inverse() * now.local_from_base;
  if (MotionGate{parameters_.range_m, parameters_.range_rad}.isExceededBy(moved)) {
    before_.reset();
    return false;
  }
  const auto ratio = discontinuity(*before_, now);
  if (!ratio || *ratio > parameters_.agreeing_ratio) agreeing_since_ns_ = now.stamp_ns;
  return now.stamp_ns >= agreeing_since_ns_ + toNanoseconds(parameters_.agreeing_s);
}

}  // namespace ram_slam
