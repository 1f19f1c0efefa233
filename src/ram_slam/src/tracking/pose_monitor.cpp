// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/pose_monitor.hpp"

#include <algorithm>
#include <vector>

#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/tracking/duration.hpp"

namespace ram_slam {
namespace {

using ram_parameters::ParameterTable;

void addInconsistency(ParameterTable<PoseMonitorParameters>& table) {
  using P = PoseMonitorParameters;
  using namespace ram_parameters;
  table.expert("Whether views agree with those of the map")
      .add(
          "max_inconsistency_s", &P::max_inconsistency_s, "s", positive(),
          "The share of contradiction beyond `contradiction` adds up over time; with so much of it "
          "a robot whose place was newly found in the map is lost, ...")
      .add("max_inconsistency_tracked_s", &P::max_inconsistency_tracked_s, "s", positive(),
           "... with so much one whose pose comes from odometry, which drifts.")
      .add("tracked_threshold_factor", &P::tracked_threshold_factor, "", atLeast(1.0),
           "By which `contradiction` is larger for the latter.")
      .add("landmarks_for_trust", &P::landmarks_for_trust, "", atLeast(1),
           "A tracked robot is not lost by its views while so many landmarks are expected ...")
      .add("quality_for_trust", &P::quality_for_trust, "", within(0.0, 1.0),
           "... and this share of them is found.")
      .add("comparison_period_s", &P::comparison_period_s, "s", atLeast(0.0),
           "Least time between two comparisons with the map's views.")
      .add("max_comparison_s", &P::max_comparison_s, "s", positive(),
           "The longest time that one comparison counts for.")
      .add("max_drift_m", &P::max_drift_m, "m", atLeast(0.0),
           "Where a pose this near agrees the map has drifted and a loop is still open, ...")
      .add("max_drift_rad", &P::max_drift_rad, "rad", atLeast(0.0),
           "... turned by this at most, ...")
      .add("drift_threshold_share", &P::drift_threshold_share, "", within(0.0, 1.0),
           "... if the views contradict it in less than this share of `contradiction`.");
}

}  // namespace

const ParameterTable<PoseMonitorParameters>& PoseMonitorParameters::table() {
  using P = PoseMonitorParameters;
  using namespace ram_parameters;
  static const auto table = [] {
    ParameterTable<P> rows;
    rows.add("discontinuity", &P::discontinuity_threshold, "", aboveUpTo(0.0, 1.0),
             "The robot is lost if a view contradicts those of half a second ago in more than this "
             "share of what both know about (up to 0.35 in ordinary driving among people, 0.06 to "
             "0.9 when the robot was carried away).")
        .add(
            "contradiction", &P::contradiction_threshold, "", aboveUpTo(0.0, 1.0),
            "Or if for some time views contradict those that the map was learned from in more than "
            "this share (0.00 to 0.05 where the map is right), four times that unless the place "
            "was found newly.")
        .include(&P::lost, LostDetectorParameters::table())
        .expert("Odometry that slipped")
        .add("max_slip_m", &P::max_slip_m, "m", atLeast(0.0), "A motion up to this ...")
        .add("max_slip_rad", &P::max_slip_rad, "rad", atLeast(0.0), "... and this ...")
        .add("slip_contradiction_ratio", &P::slip_contradiction_ratio, "", within(0.0, 1.0),
             "... after which the views contradict each other in no more than this share is a slip "
             "of the odometry: the pose is corrected by it.");
    addInconsistency(rows);
    rows.section("discontinuity_detector", &P::discontinuity_detector,
                 DiscontinuityParameters::table());
    return rows;
  }();
  return table;
}

PoseMonitor::PoseMonitor(const PoseMonitorParameters& parameters,
                         const MapViewsParameters& map_views,
                         double confirm_log_odds)
    : parameters_((parameters.validate(), parameters)),
      map_views_parameters_(map_views),
      discontinuities_(parameters.discontinuity_threshold, parameters.discontinuity_detector),
      landmarks_(parameters.lost, confirm_log_odds) {}

PoseMonitor::Finding PoseMonitor::check(const LostDetector::Reading& reading,
                                        const Pose& pose,
                                        MapViews& map_views) {
  landmarks_.add(reading, pose.path_m);
  agreement_ = landmarks_.agreement();
  const DiscontinuityDetector::Finding finding = discontinuities_.compare(pose.now);
  if (finding == DiscontinuityDetector::Finding::kSuspicious)
    landmarks_.clear();  // only what comes now counts
  if (finding == DiscontinuityDetector::Finding::kCarriedAway) return Finding::kDiscontinuity;
  if (viewsContradictMap(pose, map_views)) return Finding::kMapContradicts;
  const bool suspicious = discontinuities_.suspicious(pose.now.stamp_ns);
  if (landmarks_.lost(suspicious) && !viewAgreesWithMap(pose, map_views))
    return Finding::kMapContradicts;
  return finding == DiscontinuityDetector::Finding::kSuspicious && discontinuities_.changedAtOnce()
             ? Finding::kDoubtful
             : Finding::kConsistent;
}

std::optional<Pose2> PoseMonitor::slip(const TrackedView& now) const {
  if (discontinuities_.views().empty()) return std::nullopt;
  const TrackedView& before = discontinuities_.views().front();
  MapViews place(map_views_parameters_);
  place.add(before.stamp_ns, before.local_from_base, 0.0, before.view);
  const std::vector<LocalConstellation::PlacedView> views{{{}, now.view}};
  const Pose2 moved = place.refined(views, now.local_from_base);
  const Pose2 slip = now.local_from_base.inverse() * moved;
  const ViewAgreement agreement = place.judge(views, moved);
  if (MotionGate{parameters_.max_slip_m, parameters_.max_slip_rad}.isExceededBy(slip) ||
      agreement.compared_count == 0 ||
      agreement.contradiction_ratio > parameters_.slip_contradiction_ratio)
    return std::nullopt;
  return slip;
}

std::optional<TrackedView> PoseMonitor::oldestView() const {
  if (discontinuities_.views().empty()) return std::nullopt;
  return discontinuities_.views().front();
}

void PoseMonitor::clearMapEvidence() {
  inconsistency_s_ = 0.0;
  landmarks_.clear();
}

void PoseMonitor::clear() {
  clearMapEvidence();
  discontinuities_.clear();
}

bool PoseMonitor::viewsContradictMap(const Pose& pose, MapViews& map_views) {
  const TrackedView& now = pose.now;
  if (now.view == nullptr ||
      now.stamp_ns < compared_ns_ + toNanoseconds(parameters_.comparison_period_s))
    return false;
  const double since_s = std::min(static_cast<double>(now.stamp_ns - compared_ns_) * 1e-9,
                                  parameters_.max_comparison_s);
  compared_ns_ = now.stamp_ns;
  // A place that was found newly has no drift: then all views count.
  if (pose.source == PoseSource::kMap) map_views.trustMap(pose.path_m);
  const double ratio =
      map_views.trackedContradictionRatio(*now.view, pose.map_from_base, pose.path_m).value_or(0.0);
  inconsistency_s_ =
      std::max(0.0, inconsistency_s_ + since_s * (ratio - contradictionThreshold(pose.source)));
  const bool tracked = pose.source != PoseSource::kMap;
  const bool landmarks_agree = agreement_.expected_count >= parameters_.landmarks_for_trust &&
                               agreement_.quality() >= parameters_.quality_for_trust;
  if (tracked && landmarks_agree) inconsistency_s_ = 0.0;
  if (inconsistency_s_ <=
      (tracked ? parameters_.max_inconsistency_tracked_s : parameters_.max_inconsistency_s))
    return false;
  inconsistency_s_ = 0.0;
  return pose.source == PoseSource::kMap || !isDrift(pose, map_views);
}

double PoseMonitor::contradictionThreshold(PoseSource source) const {
  return (source == PoseSource::kMap ? 1.0 : parameters_.tracked_threshold_factor) *
         parameters_.contradiction_threshold;
}

bool PoseMonitor::viewAgreesWithMap(const Pose& pose, const MapViews& map_views) const {
  if (pose.now.view == nullptr) return false;
  const auto ratio = map_views.contradictionRatio(*pose.now.view, pose.map_from_base);
  return ratio && *ratio < contradictionThreshold(pose.source);
}

bool PoseMonitor::isDrift(const Pose& pose, const MapViews& map_views) const {
  std::vector<LocalConstellation::PlacedView> views{{{}, pose.now.view}};
  for (const TrackedView& view : discontinuities_.views())
    views.push_back({pose.now.local_from_base.inverse() * view.local_from_base, view.view});
  const Pose2 better = map_views.refined(views, pose.map_from_base);
  const Pose2 away = pose.map_from_base.inverse() * better;
  return !MotionGate{parameters_.max_drift_m, parameters_.max_drift_rad}.isReachedBy(away) &&
         map_views.judge(views, better).contradiction_ratio <
             parameters_.drift_threshold_share * parameters_.contradiction_threshold;
}

}  // namespace ram_slam
