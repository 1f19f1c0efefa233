// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// What the sensor saw, and where the robot was then by odometry alone.
struct TrackedView {
  std::int64_t stamp_ns = 0;
  Pose2 local_from_base;
  std::shared_ptr<const FieldOfView> view;  ///< null: the sensor cannot tell
};

/// Notices that a robot was carried away: what it sees contradicts all it saw half a second to a
/// second before, at the motion that odometry tells. All, because one scan that was placed wrongly
/// contradicts those before and after it and says nothing about where the robot is now.
class DiscontinuityDetector {
public:
  enum class Finding {
    kNothing,
    kSuspicious,   ///< less than a jump, but believe a map that says the same; said once
    kCarriedAway,  ///< the views show two places
  };

  /// \param threshold  share of contradiction (see discontinuity()) beyond which two views are of
  /// two places
  explicit DiscontinuityDetector(double threshold) : threshold_(threshold) {}

  /// Compares a view with those before it.
  Finding compare(const TrackedView& now);
  /// Keeps the view for those that come.
  void add(TrackedView view);
  /// Whether a small contradiction was found a moment ago.
  bool suspicious(std::int64_t now_ns) const { return now_ns <= suspicious_until_ns_; }
  /// Of the last second, oldest first.
  const std::deque<TrackedView>& views() const { return views_; }
  void clear();

private:
  std::optional<double> leastContradiction(const TrackedView& now) const;
  /// Whether the view contradicts the one right before it, which people seldom bring about.
  bool contradictsViewBefore(const TrackedView& now) const;

  double threshold_;
  std::deque<TrackedView> views_;
  std::int64_t contradicting_since_ns_ = 0;  ///< 0: the views of late agree
  bool contradicts_at_once_ = false;         ///< from one view to the next
  std::int64_t suspicious_until_ns_ = 0;
};

/// Notices that a discontinuity was a disturbance, somebody who walked by: before the robot has
/// moved on everything looks as before.
class DisturbanceDetector {
public:
  /// \param before  the last view from before the trouble; none: it never was a disturbance
  void start(std::optional<TrackedView> before, std::int64_t now_ns);
  void stop() { before_.reset(); }
  /// Whether the trouble has been over for a while.
  bool isOver(const TrackedView& now);

private:
  std::optional<TrackedView> before_;
  std::int64_t agreeing_since_ns_ = 0;
};

/// discontinuity() of field_of_view.hpp, for two views tracked by odometry.
std::optional<double> discontinuity(const TrackedView& before, const TrackedView& now);

}  // namespace ram_slam
