// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/sensing/field_of_view.hpp"

namespace ram_slam {

/// What the sensor saw, and where the robot was then by odometry alone.
struct TrackedView {
  std::int64_t stamp_ns = 0;
  Pose2 local_from_base;
  std::shared_ptr<const FieldOfView> view;  ///< null: the sensor has none
};

/// discontinuity() of field_of_view.hpp, for two views tracked by odometry.
std::optional<double> discontinuity(const TrackedView& before, const TrackedView& now);

struct DiscontinuityParameters {
  double view_period_s = 0.09;
  double oldest_reference_s = 1.0;
  double newest_reference_s = 0.45;
  double contradicting_s = 0.2;
  double suspicious_share = 0.25;  ///< of the threshold
  double sharp_share = 0.5;        ///< of the threshold
  double suspicious_s = 2.0;

  static const ram_parameters::ParameterTable<DiscontinuityParameters>& table();
};

/// Notices that a robot was carried away: what it sees contradicts all it saw half a second to a
/// second before, at the motion that odometry measured. All, because one scan that was placed
/// wrongly contradicts those before and after it and is no evidence about where the robot is now.
class DiscontinuityDetector {
public:
  enum class Finding {
    kNothing,
    kSuspicious,   ///< less than a jump: less evidence from the map is needed; reported once
    kCarriedAway,  ///< the views show two places
  };

  /// \param threshold_ratio  share of contradiction (see discontinuity()) beyond which two views
  /// are of two places
  DiscontinuityDetector(double threshold_ratio, const DiscontinuityParameters& parameters)
      : threshold_ratio_(threshold_ratio), parameters_(parameters) {}

  /// Compares a view with those before it.
  Finding compare(const TrackedView& now);
  /// Keeps the view as a reference for later ones.
  void add(TrackedView view);
  /// Whether a small contradiction was found recently.
  bool suspicious(std::int64_t now_ns) const { return now_ns <= suspicious_until_ns_; }
  /// Whether the newest contradiction came from one view to the next, which people seldom bring
  /// about.
  bool changedAtOnce() const {
    return step_ratio_ > parameters_.suspicious_share * threshold_ratio_;
  }
  /// Of the last second, oldest first.
  const std::deque<TrackedView>& views() const { return views_; }
  void clear();

private:
  std::optional<double> leastContradictionRatio(const TrackedView& now) const;
  /// The share in which the view contradicts the one right before it.
  double stepRatio(const TrackedView& now) const;

  double threshold_ratio_;
  DiscontinuityParameters parameters_;
  std::deque<TrackedView> views_;
  std::int64_t contradicting_since_ns_ = 0;  ///< 0: recent views agree
  double step_ratio_ = 0.0;                  ///< when that began
  std::int64_t suspicious_until_ns_ = 0;
};

struct DisturbanceParameters {
  double agreeing_ratio = 0.03;
  double agreeing_s = 0.3;
  double range_m = 1.0;
  double range_rad = 0.5;

  static const ram_parameters::ParameterTable<DisturbanceParameters>& table();
};

/// Notices that a discontinuity was a disturbance, people who walked by: before the robot has
/// moved on everything appears as before.
class DisturbanceDetector {
public:
  /// \param before  the last view from before the trouble; none: it never was a disturbance
  DisturbanceDetector(const DisturbanceParameters& parameters,
                      std::optional<TrackedView> before,
                      std::int64_t now_ns)
      : parameters_(parameters), before_(std::move(before)), agreeing_since_ns_(now_ns) {}

  /// Whether the trouble has been over for a while.
  bool isOver(const TrackedView& now);

private:
  DisturbanceParameters parameters_;
  std::optional<TrackedView> before_;
  std::int64_t agreeing_since_ns_;
};

}  // namespace ram_slam
