// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "ram_parameters/parameter_table.hpp"
#include "ram_slam/tracking/discontinuity_detector.hpp"
#include "ram_slam/tracking/lost_detector.hpp"
#include "ram_slam/tracking/map_views.hpp"

namespace ram_slam {

/// The table explains the fields.
struct PoseMonitorParameters {
  double discontinuity_threshold = 0.4;
  double contradiction_threshold = 0.1;
  LostDetectorParameters lost;
  double max_slip_m = 0.4;
  double max_slip_rad = 0.2;
  double slip_contradiction_ratio = 0.04;
  double max_inconsistency_s = 0.2;
  double max_inconsistency_tracked_s = 1.0;
  double tracked_threshold_factor = 4.0;
  int landmarks_for_trust = 2;
  double quality_for_trust = 0.5;
  double comparison_period_s = 0.2;
  double max_comparison_s = 0.2;
  double max_drift_m = 1.0;
  double max_drift_rad = 0.15;
  double drift_threshold_share = 0.5;
  DiscontinuityParameters discontinuity_detector;

  static const ram_parameters::ParameterTable<PoseMonitorParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// What the pose of a robot that is not lost rests on.
enum class PoseSource {
  kTracking,  ///< it was tracked all the time, or for long enough
  kOdometry,  ///< newly set by odometry: with drift
  kMap,       ///< newly found in the map, or given: without drift
};

/// Is the pose still true? Compares what the sensor shows with what it showed a moment ago, with
/// the landmarks and with the views that the map was learned from.
class PoseMonitor {
public:
  enum class Finding {
    kConsistent,
    kDoubtful,        ///< views changed at once, by less than most places differ
    kDiscontinuity,   ///< views show two places: a slip, or the robot was carried away
    kMapContradicts,  ///< landmarks or views of the map are not where they should be
  };

  /// The pose that is to be judged.
  struct Pose {
    const TrackedView& now;
    Pose2 map_from_base;
    double path_m = 0.0;  ///< driven so far
    PoseSource source = PoseSource::kMap;
  };

  /// \throws std::invalid_argument as PoseMonitorParameters::validate()
  PoseMonitor(const PoseMonitorParameters& parameters,
              const MapViewsParameters& map_views,
              double confirm_log_odds);

  /// Takes in one reading and judges the pose.
  Finding check(const LostDetector::Reading& reading, const Pose& pose, MapViews& map_views);
  /// Keeps a view that was consistent, for those to come.
  void add(const TrackedView& now) { discontinuities_.add(now); }
  /// The motion that odometry missed, if a small one makes this view agree with those before.
  std::optional<Pose2> slip(const TrackedView& now) const;
  /// The oldest of the views that new ones are compared with.
  std::optional<TrackedView> oldestView() const;

  /// How the last readings and the map agree.
  const MapAgreement& agreement() const { return agreement_; }
  /// How much recent views have contradicted those of the map: share beyond the threshold times s.
  double inconsistency_s() const { return inconsistency_s_; }

  /// The map is another one, the robot's odometry goes on.
  void clearMapEvidence();
  /// The robot is somewhere else.
  void clear();
  /// The pose was found in the map just now: for a while all its landmarks are evidence.
  void trustMap(double path_m) { landmarks_.trustMap(path_m); }

private:
  /// Whether views have contradicted those that the map was learned from for a while.
  bool viewsContradictMap(const Pose& pose, MapViews& map_views);
  /// The ratio of contradiction up to which views count as agreeing.
  double contradictionThreshold(PoseSource source) const;
  /// Whether this view is as the map's are: then landmarks that are not there were moved.
  bool viewAgreesWithMap(const Pose& pose, const MapViews& map_views) const;
  /// Whether a pose nearby would agree with the recent views.
  bool isDrift(const Pose& pose, const MapViews& map_views) const;

  PoseMonitorParameters parameters_;
  MapViewsParameters map_views_parameters_;
  DiscontinuityDetector discontinuities_;
  LostDetector landmarks_;
  MapAgreement agreement_;
  std::int64_t compared_ns_ = 0;  ///< when a view was compared with the map's last
  double inconsistency_s_ = 0.0;
};

}  // namespace ram_slam
