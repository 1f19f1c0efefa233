// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/tracker.hpp"

#include <stdexcept>
#include <utility>

#include "ram_slam/tracking/duration.hpp"

namespace ram_slam {
namespace {

PoseWithCovariance2 withSigma(const Pose2& pose, double sigma_m, double sigma_rad) {
  PoseWithCovariance2 uncertain;
  uncertain.pose = pose;
  uncertain.covariance = Eigen::Vector3d(sigma_m, sigma_m, sigma_rad).cwiseAbs2().asDiagonal();
  return uncertain;
}

/// Whether views before and after the motion can be compared.
bool isCertain(const PoseWithCovariance2& motion, const TrackingParameters& parameters) {
  const Eigen::Matrix3d& c = motion.covariance;
  const double sigma_m = parameters.known_motion_sigma_m;
  const double sigma_rad = parameters.known_motion_sigma_rad;
  return c(0, 0) + c(1, 1) < sigma_m * sigma_m && c(2, 2) < sigma_rad * sigma_rad;
}

}  // namespace

Tracker::Tracker(LandmarkFilterFactory make,
                 const RecoveryParameters& recovery,
                 FeatureMatchers matchers)
    : make_(std::move(make)),
      parameters_((recovery.validate(), recovery)),
      matchers_(std::move(matchers)),
      filter_(make_()),
      map_views_(recovery.map_views),
      monitor_(recovery.monitor, recovery.map_views, filter_->confirm_log_odds()) {}

void Tracker::update(const FeatureList& features,
                     const MotionModel& model,
                     std::shared_ptr<const FieldOfView> view) {
  const bool is_later = started() && features.stamp_ns > stamp_ns_;
  update(features, motionStep(model, is_later ? stamp_ns_ : features.stamp_ns, features.stamp_ns),
         std::move(view));
}

void Tracker::update(const FeatureList& features,
                     const MotionStep& step,
                     std::shared_ptr<const FieldOfView> view) {
  const PoseWithCovariance2& moved = step.motion;
  const FeatureList list = deskew(features, moved.pose, features.stamp_ns - stamp_ns_);
  if (lost()) {
    filter_->check(list);
    if (list.stamp_ns < stamp_ns_) {
      throw std::invalid_argument("features are older than those before");
    }
  } else {
    filter_->update(list, step, view.get());
  }
  // From here on nothing fails.
  stamp_ns_ = list.stamp_ns;
  if (!parameters_.enabled) return;
  local_from_base_ = local_from_base_ * moved.pose;
  const TrackedView now{stamp_ns_, local_from_base_, std::move(view)};
  if (lost()) {
    search(list, moved, now);
  } else {
    track(list, moved.pose, now);
  }
}

void Tracker::track(const FeatureList& list, const Pose2& moved, const TrackedView& now) {
  path_m_ += moved.translation().norm();
  if (auto* probation = std::get_if<Probation>(&state_))
    probation->remaining_m -= moved.translation().norm();
  // What was learned since the last certain moment proves nothing: a wrong pose agrees with itself.
  const FilterCopy* certain = oldestCopy();
  const LandmarkRegistry& registry = (certain == nullptr ? *filter_ : *certain->filter).registry();
  const Pose2 here = filter_->estimate().pose;
  switch (monitor_.check({list, now.view.get(), filter_->best(), registry},
                         {now, here, path_m_, poseSource()}, map_views_)) {
    case PoseMonitor::Finding::kDoubtful:
      if (std::holds_alternative<Tracked>(state_)) transition(TrackingEvent::kDoubted);
      [[fallthrough]];
    case PoseMonitor::Finding::kConsistent:
      if (isElsewhere(list, moved, now)) {
        transition(TrackingEvent::kFoundElsewhere);
      } else {
        keep(now);
      }
      break;
    case PoseMonitor::Finding::kMapContradicts:
      transition(TrackingEvent::kMapContradicted);
      break;
    case PoseMonitor::Finding::kDiscontinuity:
      if (const std::optional<Pose2> slip = monitor_.slip(now)) {
        local_from_base_ = local_from_base_ * *slip;
        transition(TrackingEvent::kSlipped,
                   withSigma(here * *slip, parameters_.tracking.resumed_sigma_m,
                             parameters_.tracking.resumed_sigma_rad));
      } else {
        transition(TrackingEvent::kCarriedAway);
      }
      break;
  }
}

bool Tracker::isElsewhere(const FeatureList& list, const Pose2& moved, const TrackedView& now) {
  if (!isDoubted()) return false;
  auto& probation = std::get<Probation>(state_);
  Relocaliser& relocaliser = *probation.relocaliser;
  relocaliser.add(list, moved, now.view);
  if (!relocaliser.isDue()) return false;
  const Pose2 here = filter_->estimate().pose;
  const auto place = relocaliser.search(
      {confirmedLandmarks(*probation.before.filter), map_views_, here, local_from_base_});
  if (!place) return false;
  const MotionGate drift{parameters_.monitor.max_drift_m, parameters_.monitor.max_drift_rad};
  if (drift.isReachedBy(here.inverse() * place->pose)) return true;
  probation.relocaliser.reset();
  probation.remaining_m = 0.0;
  return false;
}

void Tracker::keep(const TrackedView& now) {
  if (const auto* probation = std::get_if<Probation>(&state_)) {
    if (probation->remaining_m <= 0.0 && monitor_.inconsistency_s() <= 0.0)
      transition(TrackingEvent::kProbationPassed);
  } else {
    std::deque<FilterCopy>& copies = std::get<Tracked>(state_).copies;
    const std::int64_t period_ns = toNanoseconds(parameters_.tracking.copy_period_s);
    const std::int64_t old_ns = stamp_ns_ - toNanoseconds(parameters_.tracking.copy_age_s);
    if (copies.empty() || stamp_ns_ >= copies.back().stamp_ns + period_ns) {
      // The newest one that is old enough stays, and all that are newer.
      while (copies.size() >= 2 && copies[1].stamp_ns <= old_ns) copies.pop_front();
      copies.push_back(copyOfNow());
    }
  }
  if (std::holds_alternative<Tracked>(state_) && !filter_->isMapFixed())
    map_views_.add(stamp_ns_, filter_->estimate().pose, path_m_, now.view);
  monitor_.add(now);
}

void Tracker::search(const FeatureList& list,
                     const PoseWithCovariance2& moved,
                     const TrackedView& now) {
  // What was seen before an uncertain motion does not belong to what is seen after it.
  std::get<Lost>(state_).map_from_base = std::get<Lost>(state_).map_from_base * moved.pose;
  if (!isCertain(moved, parameters_.tracking)) transition(TrackingEvent::kOdometryInterrupted);
  Lost& lost = std::get<Lost>(state_);
  lost.relocaliser.add(list, moved.pose, now.view);
  if (lost.disturbance.isOver(now)) {
    transition(TrackingEvent::kDisturbanceOver,
               withSigma(lost.map_from_base, parameters_.tracking.resumed_sigma_m,
                         parameters_.tracking.resumed_sigma_rad));
    return;
  }
  if (lost.relocaliser.isDue()) {
    std::optional<Pose2> expected;
    if (lost.may_be_false_alarm) expected = lost.map_from_base;
    const auto place = lost.relocaliser.search(
        {confirmedLandmarks(*filter_), map_views_, expected, local_from_base_});
    if (place) {
      transition(TrackingEvent::kPlaceFound, *place);
      return;
    }
  }
  if (odometryIsTrusted(lost, now)) {
    transition(TrackingEvent::kOdometryTrusted,
               withSigma(lost.map_from_base, parameters_.odometry_trust.sigma_m,
                         parameters_.odometry_trust.sigma_rad));
  }
}

bool Tracker::odometryIsTrusted(Lost& lost, const TrackedView& now) const {
  const OdometryTrustParameters& trust = parameters_.odometry_trust;
  const double threshold = parameters_.monitor.contradiction_threshold;
  const double distance_m = lost.relocaliser.distance_m();
  if (lost.reason == LostReason::kMapContradicts) {
    if (distance_m >= trust.contradicted_m) return true;
    if (now.view == nullptr) return false;
    const auto ratio = map_views_.contradictionRatio(*now.view, lost.map_from_base);
    if (!ratio || *ratio > threshold) lost.walls_agree_since_ns = now.stamp_ns;
    return now.stamp_ns >= lost.walls_agree_since_ns + toNanoseconds(trust.walls_agree_s);
  }
  if (lost.reason != LostReason::kDiscontinuity || !lost.may_be_false_alarm ||
      distance_m < trust.carried_m || now.view == nullptr)
    return false;
  const auto ratio = map_views_.contradictionRatio(*now.view, lost.map_from_base);
  return !ratio || *ratio <= threshold;
}

PoseSource Tracker::poseSource() const {
  const auto* probation = std::get_if<Probation>(&state_);
  return probation == nullptr ? PoseSource::kTracking : probation->source;
}

void Tracker::transition(TrackingEvent event, const PoseWithCovariance2& pose) {
  const double probation_m = parameters_.tracking.probation_m;
  switch (event) {
    case TrackingEvent::kProbationPassed:
      state_ = Tracked{{copyOfNow()}};
      break;
    case TrackingEvent::kTrajectoryFollowed:
      if (!isDoubted()) state_ = Tracked{};
      break;
    case TrackingEvent::kDisturbanceOver:
      state_ = Tracked{{moveTo(pose)}};
      break;
    case TrackingEvent::kSlipped:
      state_ = Probation{correctTo(pose), PoseSource::kOdometry, probation_m};
      break;
    case TrackingEvent::kOdometryTrusted:
      state_ = Probation{moveTo(pose), PoseSource::kOdometry, probation_m};
      break;
    case TrackingEvent::kPlaceFound:
    case TrackingEvent::kPoseSet:
      state_ = Probation{moveTo(pose), PoseSource::kMap, probation_m};
      break;
    case TrackingEvent::kPoseSetBeforeStart:
      filter_->setPose(pose);
      state_ = Tracked{};
      break;
    case TrackingEvent::kDoubted:
      state_ = doubted();
      break;
    case TrackingEvent::kFoundElsewhere:
      state_ = foundElsewhere(*std::get<Probation>(state_).relocaliser);
      break;
    case TrackingEvent::kCarriedAway:
      state_ = loseTrack(LostReason::kDiscontinuity);
      break;
    case TrackingEvent::kMapContradicted:
      state_ = loseTrack(LostReason::kMapContradicts);
      break;
    case TrackingEvent::kPoseForgotten:
      state_ = loseTrack(LostReason::kRequested);
      break;
    case TrackingEvent::kOdometryInterrupted:
      state_ = interrupted(std::get<Lost>(state_));
      break;
  }
}

FilterCopy Tracker::moveTo(const PoseWithCovariance2& map_from_base) {
  map_views_.follow(filter_->trajectory());
  map_views_.trustMap(path_m_);
  std::unique_ptr<LandmarkFilter> moved = filter_->clone();
  moved->setPose(map_from_base, stamp_ns_);
  FilterCopy before{std::exchange(filter_, std::move(moved)), map_from_base.pose, local_from_base_,
                    stamp_ns_};
  monitor_.clear();
  monitor_.trustMap(path_m_);
  return before;
}

FilterCopy Tracker::correctTo(const PoseWithCovariance2& map_from_base) {
  const FilterCopy* oldest = oldestCopy();
  FilterCopy before = oldest == nullptr ? copyOfNow() : *oldest;
  filter_->setPose(map_from_base, stamp_ns_);
  monitor_.clear();
  return before;
}

Lost Tracker::loseTrack(LostReason reason) {
  // A caller who wants the pose forgotten does not state that the map is wrong.
  const bool requested = reason == LostReason::kRequested;
  Pose2 map_from_base = filter_->estimate().pose;
  StampedPose2 certain{stamp_ns_, map_from_base};
  if (const FilterCopy* before = requested ? nullptr : oldestCopy()) {
    map_from_base = before->map_from_base * before->local_from_base.inverse() * local_from_base_;
    certain = {before->stamp_ns, before->map_from_base};
    filter_ = before->filter->clone();
  }
  map_views_.follow(filter_->trajectory());
  std::optional<TrackedView> view_before;
  if (reason == LostReason::kDiscontinuity) view_before = monitor_.oldestView();
  monitor_.clear();
  return {reason,
          certain,
          map_from_base,
          !requested,
          stamp_ns_,
          DisturbanceDetector(parameters_.disturbance, view_before, stamp_ns_),
          Relocaliser(parameters_.relocaliser, matchers_)};
}

Lost Tracker::interrupted(const Lost& lost) const {
  return {lost.reason,
          lost.certain,
          lost.map_from_base,
          false,
          lost.walls_agree_since_ns,
          DisturbanceDetector(parameters_.disturbance, std::nullopt, stamp_ns_),
          Relocaliser(parameters_.relocaliser, matchers_)};
}

Probation Tracker::doubted() const {
  const FilterCopy* oldest = oldestCopy();
  return {oldest == nullptr ? copyOfNow() : *oldest, PoseSource::kTracking,
          parameters_.tracking.probation_m, Relocaliser(parameters_.relocaliser, matchers_)};
}

Lost Tracker::foundElsewhere(Relocaliser relocaliser) {
  // It is no false alarm, and the place is found once more before it counts.
  Lost lost = interrupted(loseTrack(LostReason::kDiscontinuity));
  lost.relocaliser = std::move(relocaliser);
  return lost;
}

FilterCopy Tracker::bent(const FilterCopy& copy, const Trajectory& smoothed) {
  std::unique_ptr<LandmarkFilter> filter = copy.filter->clone();
  filter->followTrajectory(smoothed);
  const Pose2 map_from_base = filter->estimate().pose;
  return {std::move(filter), map_from_base, copy.local_from_base, copy.stamp_ns};
}

FilterCopy Tracker::copyOfNow() const {
  return {filter_->clone(), filter_->estimate().pose, local_from_base_, stamp_ns_};
}

const FilterCopy* Tracker::oldestCopy() const {
  if (const auto* probation = std::get_if<Probation>(&state_)) return &probation->before;
  const auto* tracked = std::get_if<Tracked>(&state_);
  return tracked == nullptr || tracked->copies.empty() ? nullptr : &tracked->copies.front();
}

LostReason Tracker::reason() const {
  const auto* lost = std::get_if<Lost>(&state_);
  return lost == nullptr ? LostReason::kTracking : lost->reason;
}

StampedPose2 Tracker::certainPose() const {
  const auto* lost = std::get_if<Lost>(&state_);
  return lost == nullptr ? StampedPose2{stamp_ns_, estimate().pose} : lost->certain;
}

PoseWithCovariance2 Tracker::estimate() const {
  const auto* lost = std::get_if<Lost>(&state_);
  if (lost == nullptr) return filter_->estimate();
  return withSigma(lost->map_from_base, parameters_.tracking.lost_sigma_m,
                   parameters_.tracking.lost_sigma_rad);
}

void Tracker::setPose(const PoseWithCovariance2& map_from_base) {
  transition(started() ? TrackingEvent::kPoseSet : TrackingEvent::kPoseSetBeforeStart,
             map_from_base);
}

Pose2 Tracker::followTrajectory(const Trajectory& smoothed) {
  if (lost()) throw std::runtime_error("the robot is lost: its map stays as it is");
  if (filter_->isMapFixed()) throw std::runtime_error("the map is fixed");
  std::optional<FilterCopy> before;
  if (isDoubted()) before = bent(std::get<Probation>(state_).before, smoothed);
  const Pose2 map_from_smoothed = filter_->followTrajectory(smoothed);
  if (before) std::get<Probation>(state_).before = *std::move(before);
  map_views_.follow(filter_->trajectory());
  monitor_.clearMapEvidence();
  transition(TrackingEvent::kTrajectoryFollowed);
  return map_from_smoothed;
}

void Tracker::forgetPose() {
  if (!parameters_.enabled || filter_->registry().records().empty()) return;
  transition(TrackingEvent::kPoseForgotten);
}

void Tracker::setMap(const LandmarkMap& map, const std::vector<PlacedView>& views) {
  filter_->setMap(map, {});
  map_views_.clear();
  for (const PlacedView& view : views) map_views_.addLoaded(view);
  forgetPose();
}

Checkpoint Tracker::checkpoint() const {
  Checkpoint kept{filter_->landmarks(), filter_->trajectory()};
  kept.map.stamp_ns = stamp_ns_;
  while (!kept.path.empty() && kept.path.back().stamp_ns >= stamp_ns_) kept.path.pop_back();
  if (!lost()) kept.path.push_back({stamp_ns_, filter_->estimate().pose});
  kept.path = thinned(kept.path, parameters_.tracking.checkpoint_step);
  return kept;
}

void Tracker::restore(const Checkpoint& checkpoint) {
  Tracker restored(make_, parameters_, matchers_);
  restored.filter_->setMap(checkpoint.map, checkpoint.path);
  if (filter_->isMapFixed()) restored.fixMap();
  const PoseWithCovariance2 pose =
      withSigma(checkpoint.path.empty() ? Pose2{} : checkpoint.path.back().pose,
                parameters_.tracking.restored_sigma_m, parameters_.tracking.restored_sigma_rad);
  restored.filter_->setPose(pose, checkpoint.map.stamp_ns);
  restored.stamp_ns_ = checkpoint.map.stamp_ns;
  if (parameters_.enabled) restored.transition(TrackingEvent::kPoseSet, pose);
  if (checkpoint.isLost()) restored.forgetPose();
  *this = std::move(restored);
}

}  // namespace ram_slam
