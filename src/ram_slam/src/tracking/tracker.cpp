// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace ram_slam {
namespace {

constexpr std::int64_t kMemoryEveryNs = 2'000'000'000;
constexpr std::int64_t kMemoryAgeNs = 3'000'000'000;  // a copy this old is from before the trouble
// A motion less certain than this says nothing about whether two views belong together.
constexpr double kComparableSigma_m = 0.1;
constexpr double kComparableSigma_rad = 0.05;
constexpr double kTryEvery_m = 0.5;
constexpr double kTryEveryShare =
    0.05;  // of the way driven lost, so that long searches cost little
// And of the size of the map: a search in one of 300 m of way takes up to a second of one core, and
// a lost robot is to keep up with its scans.
constexpr double kTryEveryPerView_m = 0.02;
constexpr double kSamePlace_m = 0.4;
constexpr double kSamePlace_rad = 0.15;
constexpr double kProbation_m = 15.0;
// A small motion that odometry did not tell and that makes the views agree: it slipped.
constexpr double kMostSlip_m = 0.4;
constexpr double kMostSlip_rad = 0.2;
constexpr double kSlipContradiction = 0.04;
// Views that contradict those of the map: the share beyond what is usual adds up over time to this
// much [s] before the robot takes itself for lost.
constexpr double kMostDoubt_s = 0.2;
// Where it was not found newly but came by itself, much more is needed, for longer, and not while
// most landmarks are found.
constexpr double kTrust = 4.0;
constexpr double kMostDoubtTracked_s = 1.0;
constexpr int kLandmarksForTrust = 2;
constexpr double kQualityForTrust = 0.5;
// Odometry that was never interrupted is trusted again when the robot has found no other place
// within this way, or when the walls agree for so long where it leads.
constexpr double kGiveUp_m = 20.0;
// The same where views showed two places, but the map does not deny where odometry leads.
constexpr double kGiveUpCarried_m = 40.0;
constexpr std::int64_t kWallsAgreeForNs = 1'000'000'000;
// How uncertain the pose is then.
constexpr double kGivenUpSigma_m = 0.3;
constexpr double kGivenUpSigma_rad = 0.05;
// A pose this near at which the views agree: the map has drifted, and a loop is still open.
constexpr double kMostDrift_m = 1.0;
constexpr double kMostDrift_rad = 0.15;
constexpr std::int64_t kDoubtEveryNs = 200'000'000;
constexpr double kLongestDoubt_s = 0.2;  // that one view counts for

// What a lost robot says about where it is: anywhere around.
constexpr double kLostSigma_m = 100.0;
constexpr double kLostSigma_rad = M_PI;
constexpr double kResumeSigma_m = 0.1;
constexpr double kResumeSigma_rad = 0.05;
// How well the pose was known relative to the landmarks around, where it was kept.
constexpr double kRestoredSigma_m = 0.02;
constexpr double kRestoredSigma_rad = 0.004;

bool isCertain(const PoseWithCovariance2& motion) {
  const Eigen::Matrix3d& c = motion.covariance;
  return c(0, 0) + c(1, 1) < kComparableSigma_m * kComparableSigma_m &&
         c(2, 2) < kComparableSigma_rad * kComparableSigma_rad;
}

}  // namespace

void RecoveryParameters::validate() const {
  lost.validate();
  local.validate();
  constellation.validate();
}

RecoveryParameters readRecoveryParameters(ram_parameters::ParameterReader& all) {
  RecoveryParameters p;
  ram_parameters::ParameterReader reader = all.section("relocalisation");
  reader.read("enabled", p.enabled);
  reader.read("window", p.lost.window);
  reader.read("minimum_evidence", p.lost.minimum_evidence);
  reader.read("lost_below", p.lost.lost_below);
  reader.read("discontinuity", p.lost.discontinuity);
  reader.read("contradiction", p.lost.contradiction);
  reader.read("length", p.local.length);
  reader.read("minimum_sightings", p.local.minimum_sightings);
  reader.read("drift_per_m", p.local.drift_per_m);
  reader.read("position_sigma", p.constellation.position_sigma);
  reader.read("minimum_baseline", p.constellation.minimum_baseline);
  reader.read("minimum_pairs", p.constellation.minimum_pairs);
  reader.read("minimum_score", p.constellation.minimum_score);
  reader.read("minimum_lead", p.constellation.minimum_lead);
  reader.read("minimum_overlap", p.constellation.minimum_overlap);
  reader.rejectUnknown();
  p.validate();
  return p;
}

Tracker::Tracker(const FastSlamParameters& filter,
                 const RecoveryParameters& recovery,
                 FeatureMatchers matchers)
    : filter_parameters_(filter),
      parameters_((recovery.validate(), recovery)),
      matchers_(std::move(matchers)),
      filter_(filter, matchers_),
      discontinuities_(recovery.lost.discontinuity),
      detector_(recovery.lost),
      local_(recovery.local, matchers_) {}

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
  if (!parameters_.enabled) {
    filter_.update(list, step, view.get());
    stamp_ns_ = list.stamp_ns;
    return;
  }
  if (lost()) {
    filter_.check(list);
    if (list.stamp_ns < stamp_ns_) {
      throw std::invalid_argument("features are older than those before");
    }
    stamp_ns_ = list.stamp_ns;
    local_from_base_ = local_from_base_ * moved.pose;
    search(list, moved, {stamp_ns_, local_from_base_, std::move(view)});
    return;
  }
  filter_.update(list, step, view.get());
  // From here on nothing fails.
  stamp_ns_ = list.stamp_ns;
  local_from_base_ = local_from_base_ * moved.pose;
  path_m_ += moved.pose.translation().norm();
  if (on_probation_) probation_left_m_ -= moved.pose.translation().norm();
  const TrackedView now{stamp_ns_, local_from_base_, std::move(view)};
  // What was learned since the last certain moment proves nothing: a wrong pose agrees with itself.
  const FastSlam& known = memories_.empty() ? filter_ : memories_.front().filter;
  detector_.add(list, now.view.get(), filter_.best(), known.registry(),
                filter_parameters_.confirm_log_odds, path_m_);
  agreement_ = detector_.agreement();
  const DiscontinuityDetector::Finding finding = discontinuities_.compare(now);
  if (finding == DiscontinuityDetector::Finding::kSuspicious)
    detector_.clear();  // only what comes now counts
  if (finding == DiscontinuityDetector::Finding::kCarriedAway) {
    if (const std::optional<Pose2> slip = slipUpTo(now)) {
      correctBy(*slip);
    } else {
      loseTrack(LostReason::kDiscontinuity);
    }
  } else if (contradictsMap(now) ||
             (detector_.lost(discontinuities_.suspicious(stamp_ns_)) && !agreesWithMap(now))) {
    loseTrack(LostReason::kMapContradicts);
  } else {
    remember();
    if (!on_probation_) map_views_.add(stamp_ns_, filter_.estimate().pose, path_m_, now.view);
    discontinuities_.add(now);
  }
}

std::optional<Pose2> Tracker::slipUpTo(const TrackedView& now) const {
  if (discontinuities_.views().empty()) return std::nullopt;
  const TrackedView& before = discontinuities_.views().front();
  MapViews place;
  place.add(before.stamp_ns, before.local_from_base, path_m_, before.view);
  const std::vector<LocalConstellation::PlacedView> views{{{}, now.view}};
  const Pose2 moved = place.refined(views, now.local_from_base);
  const Pose2 slip = now.local_from_base.inverse() * moved;
  const ViewAgreement agreement = place.judge(views, moved);
  if (slip.translation().norm() > kMostSlip_m || std::abs(slip.yaw_rad) > kMostSlip_rad ||
      agreement.compared_count == 0 || agreement.contradiction > kSlipContradiction)
    return std::nullopt;
  return slip;
}

void Tracker::correctBy(const Pose2& slip) {
  local_from_base_ = local_from_base_ * slip;
  PoseWithCovariance2 pose;
  pose.pose = filter_.estimate().pose * slip;
  pose.covariance =
      Eigen::Vector3d(kResumeSigma_m, kResumeSigma_m, kResumeSigma_rad).cwiseAbs2().asDiagonal();
  if (memories_.empty()) remember();
  memories_.erase(memories_.begin() + 1, memories_.end());
  filter_.setPose(pose, stamp_ns_);
  on_probation_ = true;
  place_was_found_ = false;
  probation_left_m_ = kProbation_m;
  discontinuities_.clear();
  detector_.clear();
  doubt_s_ = 0.0;
}

bool Tracker::contradictsMap(const TrackedView& now) {
  if (now.view == nullptr || now.stamp_ns < doubted_ns_ + kDoubtEveryNs) return false;
  const double since_s =
      std::min(static_cast<double>(now.stamp_ns - doubted_ns_) * 1e-9, kLongestDoubt_s);
  doubted_ns_ = now.stamp_ns;
  // A place that was found newly has no drift: then all views count.
  if (on_probation_ && place_was_found_) map_views_.trustMap(path_m_);
  const double share = map_views_.watch(*now.view, filter_.estimate().pose, path_m_).value_or(0.0);
  doubt_s_ = std::max(0.0, doubt_s_ + since_s * (share - usualContradiction()));
  const bool landmarks_agree =
      agreement_.expected_count >= kLandmarksForTrust && agreement_.quality() >= kQualityForTrust;
  if (!on_probation_ && landmarks_agree) doubt_s_ = 0.0;
  if (doubt_s_ <= (on_probation_ ? kMostDoubt_s : kMostDoubtTracked_s)) return false;
  doubt_s_ = 0.0;
  return (on_probation_ && place_was_found_) || !isDrift(now);
}

double Tracker::usualContradiction() const {
  return (on_probation_ ? 1.0 : kTrust) * parameters_.lost.contradiction;
}

bool Tracker::agreesWithMap(const TrackedView& now) const {
  if (now.view == nullptr) return false;
  const auto share = map_views_.contradiction(*now.view, filter_.estimate().pose);
  return share && *share < usualContradiction();
}

bool Tracker::isDrift(const TrackedView& now) const {
  std::vector<LocalConstellation::PlacedView> views{{{}, now.view}};
  for (const TrackedView& view : discontinuities_.views())
    views.push_back({now.local_from_base.inverse() * view.local_from_base, view.view});
  const Pose2& here = filter_.estimate().pose;
  const Pose2 better = map_views_.refined(views, here);
  const Pose2 away = here.inverse() * better;
  return away.translation().norm() < kMostDrift_m && std::abs(away.yaw_rad) < kMostDrift_rad &&
         map_views_.judge(views, better).contradiction < 0.5 * parameters_.lost.contradiction;
}

void Tracker::remember() {
  if (on_probation_) {
    if (probation_left_m_ > 0.0 || doubt_s_ > 0.0) return;
    on_probation_ = false;
    memories_.clear();
  }
  if (!memories_.empty() && stamp_ns_ < memories_.back().stamp_ns + kMemoryEveryNs) return;
  // The newest one that is old enough stays, and all that are newer.
  while (memories_.size() >= 2 && memories_[1].stamp_ns <= stamp_ns_ - kMemoryAgeNs)
    memories_.pop_front();
  memories_.push_back({filter_, filter_.estimate().pose, local_from_base_, stamp_ns_});
}

void Tracker::loseTrack(LostReason reason) {
  reason_ = reason;
  may_be_false_alarm_ = reason != LostReason::kRequested;
  if (!memories_.empty()) {
    const Memory& before = memories_.front();
    dead_reckoned_.pose =
        before.map_from_base * before.local_from_base.inverse() * local_from_base_;
    filter_ = before.filter;
  } else {
    dead_reckoned_.pose = filter_.estimate().pose;
  }
  memories_.clear();
  on_probation_ = false;
  map_views_.follow(filter_.trajectory());
  std::optional<TrackedView> before;
  if (reason == LostReason::kDiscontinuity && !discontinuities_.views().empty())
    before = discontinuities_.views().front();
  disturbance_.start(before, stamp_ns_);
  discontinuities_.clear();
  doubt_s_ = 0.0;
  detector_.clear();
  walls_agree_since_ns_ = stamp_ns_;
  local_.clear();
  next_try_m_ = kTryEvery_m;
  found_.reset();
}

void Tracker::search(const FeatureList& list,
                     const PoseWithCovariance2& moved,
                     const TrackedView& now) {
  dead_reckoned_.pose = dead_reckoned_.pose * moved.pose;
  if (!isCertain(moved)) {  // what was seen before does not belong to what is seen now
    local_.clear();
    next_try_m_ = kTryEvery_m;
    found_.reset();
    disturbance_.stop();
    may_be_false_alarm_ = false;
  }
  local_.add(list, moved.pose, now.view);
  if (disturbance_.isOver(now)) {
    resumeByOdometry(kResumeSigma_m, kResumeSigma_rad);
    on_probation_ = false;  // it never was elsewhere
    return;
  }
  if (local_.distance_m() >= next_try_m_) tryToRecover();
  if (!lost()) return;
  if ((reason_ == LostReason::kMapContradicts && odometryIsRight(now)) ||
      (reason_ == LostReason::kDiscontinuity && nothingDeniesOdometry(now)))
    resumeByOdometry(kGivenUpSigma_m, kGivenUpSigma_rad);
}

void Tracker::resumeByOdometry(double sigma_m, double sigma_rad) {
  PoseWithCovariance2 pose = dead_reckoned_;
  pose.covariance = Eigen::Vector3d(sigma_m, sigma_m, sigma_rad).cwiseAbs2().asDiagonal();
  resume(pose);
  place_was_found_ = false;
}

bool Tracker::odometryIsRight(const TrackedView& now) {
  if (local_.distance_m() >= kGiveUp_m) return true;
  if (now.view == nullptr) return false;
  const auto share = map_views_.contradiction(*now.view, dead_reckoned_.pose);
  if (!share || *share > parameters_.lost.contradiction) walls_agree_since_ns_ = now.stamp_ns;
  return now.stamp_ns >= walls_agree_since_ns_ + kWallsAgreeForNs;
}

bool Tracker::nothingDeniesOdometry(const TrackedView& now) const {
  if (!may_be_false_alarm_ || local_.distance_m() < kGiveUpCarried_m || now.view == nullptr)
    return false;
  const auto share = map_views_.contradiction(*now.view, dead_reckoned_.pose);
  return !share || *share <= parameters_.lost.contradiction;
}

void Tracker::tryToRecover() {
  next_try_m_ =
      local_.distance_m() + std::max({kTryEvery_m, kTryEveryShare * local_.distance_m(),
                                      kTryEveryPerView_m * static_cast<double>(map_views_.size())});
  std::optional<Pose2> expected;
  if (may_be_false_alarm_) expected = dead_reckoned_.pose;
  const std::optional<PoseWithCovariance2> place = findPlace(
      mapConstellation(), local_, map_views_, expected, matchers_, parameters_.constellation);
  if (!place) {
    found_.reset();
    return;
  }
  const Pose2 map_from_local = place->pose * local_from_base_.inverse();
  const std::optional<Pose2> before = std::exchange(found_, map_from_local);
  if (!before) return;
  const Pose2 difference = (*before * local_from_base_).inverse() * place->pose;
  if (difference.translation().norm() > kSamePlace_m ||
      std::abs(difference.yaw_rad) > kSamePlace_rad) {
    return;
  }
  resume(*place);
}

Constellation Tracker::mapConstellation() const {
  Constellation map;
  for (const LandmarkEstimate& estimate : filter_.landmarks().landmarks) {
    if (estimate.existence_log_odds < filter_parameters_.confirm_log_odds) continue;
    map.push_back({estimate.type, estimate.mean_m, estimate.covariance_m2,
                   filter_.registry().find(estimate.id)->descriptors, estimate.orientation_rad,
                   estimate.orientation_variance_rad2});
  }
  return map;
}

void Tracker::resume(const PoseWithCovariance2& map_from_base) {
  map_views_.follow(filter_.trajectory());
  map_views_.trustMap(path_m_);
  FastSlam moved = filter_;
  moved.setPose(map_from_base, stamp_ns_);
  memories_.clear();
  memories_.push_back({filter_, map_from_base.pose, local_from_base_, stamp_ns_});
  filter_ = std::move(moved);
  on_probation_ = true;
  place_was_found_ = true;
  probation_left_m_ = kProbation_m;
  reason_ = LostReason::kTracking;
  disturbance_.stop();
  local_.clear();
  detector_.clear();
  detector_.trustMap(path_m_);
  discontinuities_.clear();
  doubt_s_ = 0.0;
  found_.reset();
}

PoseWithCovariance2 Tracker::estimate() const {
  if (!lost()) return filter_.estimate();
  PoseWithCovariance2 unknown = dead_reckoned_;
  unknown.covariance =
      Eigen::Vector3d(kLostSigma_m, kLostSigma_m, kLostSigma_rad).cwiseAbs2().asDiagonal();
  return unknown;
}

void Tracker::setPose(const PoseWithCovariance2& map_from_base) {
  if (!started()) {
    filter_.setPose(map_from_base);
    reason_ = LostReason::kTracking;
    return;
  }
  resume(map_from_base);
}

Pose2 Tracker::followTrajectory(const Trajectory& smoothed) {
  if (lost()) throw std::runtime_error("the robot is lost: its map stays as it is");
  const Pose2 map_from_smoothed = filter_.followTrajectory(smoothed);
  memories_.clear();
  on_probation_ = false;
  map_views_.follow(filter_.trajectory());
  doubt_s_ = 0.0;
  detector_.clear();
  return map_from_smoothed;
}

void Tracker::forgetPose() {
  if (!parameters_.enabled || filter_.registry().records().empty()) return;
  memories_.clear();
  loseTrack(LostReason::kRequested);
}

void Tracker::setMap(const LandmarkMap& map) {
  filter_.setMap(map);
  map_views_.clear();
  forgetPose();
}

Checkpoint Tracker::checkpoint() const {
  Checkpoint kept{filter_.landmarks(), filter_.trajectory()};
  kept.map.stamp_ns = stamp_ns_;
  while (!kept.path.empty() && kept.path.back().stamp_ns >= stamp_ns_) kept.path.pop_back();
  if (!lost()) kept.path.push_back({stamp_ns_, filter_.estimate().pose});
  kept.path = thinned(kept.path);
  return kept;
}

void Tracker::restore(const Checkpoint& checkpoint) {
  Tracker restored(filter_parameters_, parameters_, matchers_);
  restored.filter_.setMap(checkpoint.map, checkpoint.path);
  PoseWithCovariance2 pose;
  if (!checkpoint.path.empty()) pose.pose = checkpoint.path.back().pose;
  pose.covariance = Eigen::Vector3d(kRestoredSigma_m, kRestoredSigma_m, kRestoredSigma_rad)
                        .cwiseAbs2()
                        .asDiagonal();
  restored.filter_.setPose(pose, checkpoint.map.stamp_ns);
  restored.stamp_ns_ = checkpoint.map.stamp_ns;
  if (parameters_.enabled) restored.resume(pose);
  if (checkpoint.isLost()) restored.forgetPose();
  *this = std::move(restored);
}

}  // namespace ram_slam
