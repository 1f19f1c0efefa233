// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/calibration/stamp_offset.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "ram_slam/geometry/trajectory.hpp"

namespace ram_slam {
namespace {

std::int64_t toNanoseconds(double duration_s) {
  return static_cast<std::int64_t>(std::llround(duration_s * 1e9));
}

}  // namespace

const ram_parameters::ParameterTable<StampOffsetParameters>& StampOffsetParameters::table() {
  using namespace ram_parameters;
  using P = StampOffsetParameters;
  static const auto table =
      ParameterTable<P>()
          .add("step_s", &P::step_s, "s", within(0.001, 1.0),
               "Between the offsets that are compared; smaller ones are taken for 0.")
          .add("turn_rad", &P::turn_rad, "rad", positive(),
               "Turns of at least this angle are compared.")
          .add("max_turn_s", &P::max_turn_s, "s", positive(), "Turns that take longer are not.")
          .add("max_error_rad", &P::max_error_rad, "rad", positive(),
               "A turn contributes at most this error: more is slip, not a matter of stamps.")
          .add("min_turns", &P::min_turns, "", atLeast(1), "Turns before an offset is used.")
          .add("min_gain", &P::min_gain, "", within(0.0, 1.0),
               "Share of the error without an offset that the best offset must take away.")
          .add("max_readings", &P::max_readings, "", atLeast(2),
               "Readings of the wheels that are kept while scans lag behind.");
  return table;
}

StampOffset::StampOffset(double max_offset_s, const StampOffsetParameters& parameters)
    : parameters_(parameters),
      step_ns_(toNanoseconds(parameters.step_s)),
      max_turn_ns_(toNanoseconds(parameters.max_turn_s)),
      max_offset_ns_(toNanoseconds(max_offset_s)) {
  if (!(max_offset_s >= 0.0 && max_offset_s <= 1.0)) {
    throw std::invalid_argument("max_stamp_offset_s must be in [0, 1], got " +
                                std::to_string(max_offset_s));
  }
  max_offset_ns_ -= max_offset_ns_ % step_ns_;
  errors_rad_.resize(static_cast<std::size_t>(2 * max_offset_ns_ / step_ns_) + 1, 0.0);
}

void StampOffset::addWheels(const StampedPose2& odom_from_base) {
  if (max_offset_ns_ == 0) return;
  wheels_.push_back(odom_from_base);
  while (!waiting_.empty() &&
         waiting_.front().to.stamp_ns + max_offset_ns_ <= odom_from_base.stamp_ns) {
    compare(waiting_.front());
    waiting_.pop_front();
  }
  const std::int64_t needed_ns = (waiting_.empty() ? odom_from_base.stamp_ns - 2 * max_turn_ns_
                                                   : waiting_.front().from.stamp_ns) -
                                 max_offset_ns_;
  while (wheels_.size() > static_cast<std::size_t>(parameters_.max_readings) ||
         (wheels_.size() > 2 && wheels_[1].stamp_ns < needed_ns)) {
    wheels_.pop_front();
  }
}

void StampOffset::addScan(const StampedPose2& odom_from_base) {
  if (max_offset_ns_ == 0) return;
  if (!start_) start_ = odom_from_base;
  const bool too_long = odom_from_base.stamp_ns - start_->stamp_ns > max_turn_ns_;
  const bool turned = std::abs(wrapAngle(odom_from_base.pose.yaw_rad - start_->pose.yaw_rad)) >=
                      parameters_.turn_rad;
  if (turned && !too_long) waiting_.push_back({*start_, odom_from_base});
  if (turned || too_long) start_ = odom_from_base;
}

void StampOffset::compare(const Turn& turn) {
  const double by_scans_rad = wrapAngle(turn.to.pose.yaw_rad - turn.from.pose.yaw_rad);
  std::vector<double> errors_rad;
  for (std::int64_t offset_ns = -max_offset_ns_; offset_ns <= max_offset_ns_;
       offset_ns += step_ns_) {
    const auto before = odometryAt(wheels_, turn.from.stamp_ns + offset_ns);
    const auto after = odometryAt(wheels_, turn.to.stamp_ns + offset_ns);
    if (!before || !after) return;
    errors_rad.push_back(
        std::min(parameters_.max_error_rad,
                 std::abs(wrapAngle(after->yaw_rad - before->yaw_rad - by_scans_rad))));
  }
  for (std::size_t i = 0; i < errors_rad.size(); ++i) errors_rad_[i] += errors_rad[i];
  if (++turn_count_ >= static_cast<std::size_t>(parameters_.min_turns)) decide();
}

void StampOffset::decide() {
  const auto best = std::min_element(errors_rad_.begin(), errors_rad_.end());
  const double without_rad = errors_rad_[errors_rad_.size() / 2];
  offset_ns_ = 0;
  if (*best > (1.0 - parameters_.min_gain) * without_rad) return;
  double fraction = 0.0;
  if (best != errors_rad_.begin() && best + 1 != errors_rad_.end()) {
    const double curvature = *(best - 1) - 2.0 * *best + *(best + 1);
    if (curvature > 0.0) fraction = 0.5 * (*(best - 1) - *(best + 1)) / curvature;
  }
  const auto offset_ns = static_cast<std::int64_t>(
      (static_cast<double>(best - errors_rad_.begin()) + fraction) * static_cast<double>(step_ns_));
  if (std::abs(offset_ns - max_offset_ns_) >= step_ns_) offset_ns_ = offset_ns - max_offset_ns_;
}

}  // namespace ram_slam
