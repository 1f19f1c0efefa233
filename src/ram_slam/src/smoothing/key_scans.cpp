// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/key_scans.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {
namespace {

// Between successive key scans of a loaded map: so little that the map stays as it is, and enough
// for the solver's precision.
constexpr double kLoadedDeviationM = 1e-4;
constexpr double kLoadedDeviationRad = 1e-5;

Eigen::Vector2d viewCentre(const SurfaceScan& surfaces, double range_m) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (const SurfacePoint& point : surfaces.points) {
    const Eigen::Vector2d place(point.x_m, point.y_m);
    if (place.norm() > range_m) continue;
    sum += place;
    count += 1.0;
  }
  return count > 0.0 ? Eigen::Vector2d(sum / count) : sum;
}

/// Whether most beams met something: scans of open ground cannot contradict each other.
bool seesWalls(const SurfaceScan& surfaces) {
  return 2 * surfaces.points.size() > surfaces.point_of_beam.size();
}

}  // namespace

KeyScans::KeyScans(const KeyScanParameters& parameters,
                   const SurfaceParameters& surfaces,
                   const ScanMatcherParameters& matcher,
                   double min_inlier_ratio,
                   const NearViewParameters& near_views)
    : parameters_(parameters),
      surfaces_(surfaces),
      matcher_(matcher),
      min_inlier_ratio_(min_inlier_ratio),
      near_views_(near_views) {}

void KeyScans::load(const std::vector<PlacedScan>& scans) {
  for (const PlacedScan& placed : scans) {
    if (!keys_.empty() && !isKeyScan(placed.map_from_base())) continue;
    KeyScan key;
    key.stamp_ns = placed.scan.stamp_ns;
    key.surfaces = extractSurfaces(placed.scan, surfaces_, placed.last_beam);
    key.view_centre_in_laser_m = viewCentre(key.surfaces, parameters_.view_range_m);
    key.base_from_laser = placed.base_from_laser;
    key.odom_from_laser = key.map_from_laser = placed.map_from_laser;
    key.is_loaded = true;
    if (!keys_.empty()) {
      const Pose2 motion = relativePose(keys_.back(), key);
      key.path_m = keys_.back().path_m + motion.translation().norm();
      const Eigen::Vector3d deviations(kLoadedDeviationM, kLoadedDeviationM, kLoadedDeviationRad);
      PoseEdge edge{keys_.size() - 1, keys_.size(), motion};
      edge.information = deviations.cwiseAbs2().cwiseInverse().asDiagonal();
      aligned_motion_.push_back(edge);
    }
    keys_.push_back(std::move(key));
  }
}

void KeyScans::addPossibleJump(std::int64_t from_ns, std::int64_t until_ns) {
  possible_jump_ = {from_ns, until_ns};
  placePossibleJump();
}

void KeyScans::placePossibleJump() {
  if (!possible_jump_ || keys_.empty() || keys_.back().stamp_ns <= possible_jump_->until_ns) return;
  const StampInterval interval = *std::exchange(possible_jump_, std::nullopt);
  KeyScan* least = nullptr;
  for (std::size_t i = std::max<std::size_t>(session_begin_ + 1, 1); i < keys_.size(); ++i) {
    KeyScan& key = keys_[i];
    if (key.stamp_ns <= interval.from_ns) continue;
    if (least == nullptr || key.inlier_ratio < least->inlier_ratio) least = &key;
    if (key.stamp_ns > interval.until_ns) break;
  }
  if (least != nullptr) least->may_be_jump = true;
}

bool KeyScans::add(const LaserScan& scan,
                   const Pose2& base_from_laser,
                   const Pose2& odom_from_base) {
  if (!base_from_laser.isFinite() || !odom_from_base.isFinite())
    throw std::invalid_argument("pose not finite");
  scan.validate();
  if (!scans_.empty() && scan.stamp_ns <= scans_.back().stamp_ns) {
    throw std::invalid_argument("scan of stamp " + std::to_string(scan.stamp_ns) +
                                " ns, not later than the last one, " +
                                std::to_string(scans_.back().stamp_ns) + " ns");
  }
  const auto gap_ns = static_cast<std::int64_t>(parameters_.jump_gap_s * 1e9);
  const bool is_after_gap = !scans_.empty() && scan.stamp_ns - scans_.back().stamp_ns > gap_ns;
  const bool is_key = keys_.empty() || starts_session_ || is_after_gap || isKeyScan(odom_from_base);
  const bool is_between = !is_key && isBetweenScan(odom_from_base);
  SurfaceScan surfaces;
  if (is_key || is_between) surfaces = surfacesOf(scan, base_from_laser, odom_from_base);
  if (!keepsLast(scan.stamp_ns, is_key || is_between)) scans_.pop_back();
  if (is_key) {
    addKeyScan(scan.stamp_ns, std::move(surfaces), base_from_laser, odom_from_base);
    keys_.back().may_be_jump |= is_after_gap && !keys_.back().is_start;
    placePossibleJump();
  } else if (is_between) {
    between_scans_.push_back({scans_.size(), std::move(surfaces), base_from_laser});
  }
  const bool is_kept = is_key || is_between || parameters_.pose_per_scan;
  scans_.push_back({scan.stamp_ns, keys_.size() - 1, odom_from_base, {}, is_kept});
  return is_key;
}

bool KeyScans::keepsLast(std::int64_t next_ns, bool next_is_kept) const {
  if (scans_.empty() || scans_.back().is_kept) return true;
  const std::size_t last = scans_.size() - 1;  // not the first, which is a key scan
  const auto rest_ns = static_cast<std::int64_t>(parameters_.rest_s * 1e9);
  return starts_session_ || next_ns - scans_[last].stamp_ns > rest_ns ||
         (next_is_kept && scans_[last].stamp_ns - scans_[last - 1].stamp_ns > rest_ns);
}

bool KeyScans::isKeyScan(const Pose2& odom_from_base) const {
  const MotionGate gate{parameters_.distance_m, parameters_.angle_rad};
  return gate.isReachedBy(keys_.back().odom_from_base().inverse() * odom_from_base);
}

bool KeyScans::isBetweenScan(const Pose2& odom_from_base) const {
  const MotionGate gate{parameters_.between_distance_m, parameters_.between_angle_rad};
  const Pose2 odom_from_last = between_scans_.empty()
                                   ? keys_.back().odom_from_base()
                                   : scans_[between_scans_.back().record].odom_from_base;
  return gate.isReachedBy(odom_from_last.inverse() * odom_from_base);
}

SurfaceScan KeyScans::surfacesOf(const LaserScan& scan,
                                 const Pose2& base_from_laser,
                                 const Pose2& odom_from_base) const {
  Pose2 last_beam;
  if (!scans_.empty() && !starts_session_) {
    const Pose2 motion = scans_.back().odom_from_base.inverse() * odom_from_base;
    last_beam = continued(base_from_laser.inverse() * motion * base_from_laser,
                          scan.stamp_ns - scans_.back().stamp_ns, scan.duration_ns());
  }
  return extractSurfaces(scan, surfaces_, last_beam);
}

void KeyScans::addKeyScan(std::int64_t stamp_ns,
                          SurfaceScan surfaces,
                          const Pose2& base_from_laser,
                          const Pose2& odom_from_base) {
  KeyScan key;
  key.stamp_ns = stamp_ns;
  key.view_centre_in_laser_m = viewCentre(surfaces, parameters_.view_range_m);
  key.surfaces = std::move(surfaces);
  key.base_from_laser = base_from_laser;
  key.odom_from_laser = odom_from_base * base_from_laser;
  key.map_from_laser = key.odom_from_laser;
  key.is_start = std::exchange(starts_session_, false) && !keys_.empty();
  if (key.is_start) {
    key.path_m = keys_.back().path_m + parameters_.start_path_m;
    keys_.push_back(std::move(key));
    session_begin_ = keys_.size() - 1;
    aligned_motion_.push_back(startEdge());
    between_scans_.clear();
    unmet_key_.reset();
    return;
  }
  if (!keys_.empty()) {
    const KeyScan& last = keys_.back();
    const Pose2 motion = last.odom_from_laser.inverse() * key.odom_from_laser;
    key.map_from_laser = last.map_from_laser * motion;
    key.path_m = last.path_m + motion.translation().norm() +
                 parameters_.path_m_per_rad * std::abs(motion.yaw_rad);
  }
  keys_.push_back(std::move(key));
  if (keys_.size() == 1) return;
  keys_.back().inlier_ratio = alignNewest();
  reviewJumps(keys_.back().inlier_ratio);
  alignNewestWithMap();
  alignBetweenScans();
}

double KeyScans::alignNewest() {
  // The given motion is the prior of the alignment.
  PoseEdge edge = givenEdge(keys_.size() - 1);
  const ScanMatch match =
      matchScan(keys_.back().surfaces, scansBefore(edge.to), {edge.from_from_to, edge.information},
                edge.from_from_to, matcher_);
  edge.from_from_to = match.map_from_laser;
  edge.information = withFloor(edge.information + match.information, parameters_.match_deviation_m,
                               parameters_.match_deviation_rad);
  aligned_motion_.push_back(edge);
  keys_.back().map_from_laser = keys_[edge.from].map_from_laser * edge.from_from_to;
  return match.inlier_ratio;
}

void KeyScans::alignNewestWithMap() {
  KeyScan& newest = keys_.back();
  const auto meets = [&](std::size_t key) {
    const Pose2 expected = relativePose(keys_[key], newest);
    return sumPointToLine(keys_[key].surfaces, newest.surfaces, expected, matcher_.firstPairing())
               .inlierRatio() >= min_inlier_ratio_;
  };
  std::vector<ReferenceScan> references;
  for (const std::size_t key : nearViews(keys_, keys_.size() - 1, near_views_, meets))
    references.push_back({&keys_[key].surfaces, keys_[key].map_from_laser});
  if (references.empty()) return;
  const PoseEdge& motion = aligned_motion_.back();
  const Eigen::Matrix3d turn = keys_[motion.from].map_from_laser.axesRotation();
  const PosePrior prior{newest.map_from_laser,
                        parameters_.motion_weight * (turn * motion.information * turn.transpose())};
  newest.map_from_laser =
      matchScan(newest.surfaces, references, prior, newest.map_from_laser, matcher_).map_from_laser;
}

std::vector<ReferenceScan> KeyScans::scansBefore(std::size_t key) const {
  const auto farthest = static_cast<std::size_t>(parameters_.farthest_reference);
  std::vector<ReferenceScan> references;
  const std::size_t most = std::min(key - session_begin_, farthest);
  for (std::size_t back = 1; back <= most; back *= 2) {
    references.push_back(
        {&keys_[key - back].surfaces, relativePose(keys_[key - 1], keys_[key - back])});
  }
  return references;
}

double KeyScans::inlierRatioBefore(std::size_t key) const {
  const Pose2 guess = relativePose(keys_[key - 1], keys_.back());
  const PosePrior prior{guess, parameters_.motion_noise.information(guess)};
  return matchScan(keys_.back().surfaces, scansBefore(key), prior, guess, matcher_).inlier_ratio;
}

void KeyScans::reviewJumps(double inlier_ratio) {
  const std::size_t newest = keys_.size() - 1;
  const std::size_t first = unmet_key_.value_or(newest);
  if (unmet_key_) inlier_ratio = inlierRatioBefore(first);
  unmet_key_.reset();
  const bool see_walls = seesWalls(keys_[newest].surfaces) && seesWalls(keys_[first - 1].surfaces);
  if (!see_walls || inlier_ratio >= parameters_.jump_inlier_ratio) return;
  if (newest + 1 - first < static_cast<std::size_t>(parameters_.jump_key_scans)) {
    unmet_key_ = first;
  } else {
    keys_[first].may_be_jump = true;
  }
}

PoseEdge KeyScans::startEdge() const {
  const std::size_t to = keys_.size() - 1;
  const Eigen::Vector3d deviations(parameters_.start_deviation_m, parameters_.start_deviation_m,
                                   parameters_.start_deviation_rad);
  PoseEdge edge{to - 1, to, relativePose(keys_[to - 1], keys_[to])};
  edge.information = deviations.cwiseAbs2().cwiseInverse().asDiagonal();
  return edge;
}

PoseEdge KeyScans::givenEdge(std::size_t to) const {
  // Nothing but this was given of these.
  if (keys_[to].is_loaded || keys_[to].is_start) return aligned_motion_[to - 1];
  PoseEdge edge;
  edge.from = to - 1;
  edge.to = to;
  edge.from_from_to = keys_[to - 1].odom_from_laser.inverse() * keys_[to].odom_from_laser;
  edge.information = parameters_.motion_noise.information(edge.from_from_to);
  if (keys_[to].is_jump) {
    const Eigen::Vector3d deviations(parameters_.jump_deviation_m, parameters_.jump_deviation_m,
                                     parameters_.jump_deviation_rad);
    edge.information = deviations.cwiseAbs2().cwiseInverse().asDiagonal();
  }
  return edge;
}

std::vector<PoseEdge> KeyScans::givenMotion() const {
  std::vector<PoseEdge> edges;
  for (std::size_t to = 1; to < keys_.size(); ++to) edges.push_back(givenEdge(to));
  return edges;
}

void KeyScans::alignBetweenScans() {
  if (between_scans_.empty()) return;
  const auto most = static_cast<std::size_t>(parameters_.between_reference_count);
  std::vector<ReferenceScan> references;
  const std::size_t count = std::min(keys_.size() - session_begin_, most);
  for (std::size_t key = keys_.size() - count; key < keys_.size(); ++key)
    references.push_back({&keys_[key].surfaces, keys_[key].map_from_laser});
  const KeyScan& before = keys_[keys_.size() - 2];
  for (const BetweenScan& between : between_scans_) {
    ScanRecord& scan = scans_[between.record];
    const Pose2 expected = poseByKeyScans(scan) * between.base_from_laser;
    const Pose2 motion =
        before.odom_from_laser.inverse() * scan.odom_from_base * between.base_from_laser;
    const PosePrior prior{expected, parameters_.motion_noise.information(motion)};
    const ScanMatch match = matchScan(between.surfaces, references, prior, expected, matcher_);
    if (match.inlier_ratio < min_inlier_ratio_) continue;
    const Pose2 shift = expected.inverse() * match.map_from_laser;
    scan.shift = between.base_from_laser * shift * between.base_from_laser.inverse();
  }
  shareShifts(before.stamp_ns, keys_.back().stamp_ns);
  between_scans_.clear();
}

void KeyScans::shareShifts(std::int64_t from_ns, std::int64_t to_ns) {
  std::size_t i = between_scans_.front().record;
  while (i > 0 && scans_[i - 1].stamp_ns > from_ns) --i;
  Pose2 from_shift;
  const auto shareUpTo = [&](std::size_t end, std::int64_t end_ns, const Pose2& end_shift) {
    for (; i < end; ++i) {
      const auto since = static_cast<double>(scans_[i].stamp_ns - from_ns);
      scans_[i].shift =
          interpolate(from_shift, end_shift, since / static_cast<double>(end_ns - from_ns));
    }
    from_ns = end_ns;
    from_shift = end_shift;
  };
  for (const BetweenScan& between : between_scans_) {
    const ScanRecord& scan = scans_[between.record];
    shareUpTo(between.record, scan.stamp_ns, scan.shift);
    ++i;  // itself
  }
  shareUpTo(scans_.size(), to_ns, {});
}

Pose2 KeyScans::poseByKeyScans(const ScanRecord& scan) const {
  // It keeps its place relative to each of the two, each by the share of the other's path.
  const auto corrected = [&scan](const KeyScan& key) {
    const Pose2 key_laser_from_base = key.odom_from_laser.inverse() * scan.odom_from_base;
    return key.map_from_laser * key_laser_from_base;
  };
  const KeyScan& before = keys_[scan.key];
  const Pose2 pose = corrected(before);
  if (scan.key + 1 == keys_.size() || scan.stamp_ns == before.stamp_ns) return pose;
  const KeyScan& after = keys_[scan.key + 1];
  if (after.is_jump || after.is_start) return pose;
  const auto since = static_cast<double>(scan.stamp_ns - before.stamp_ns);
  const auto interval = static_cast<double>(after.stamp_ns - before.stamp_ns);
  return interpolate(pose, corrected(after), since / interval);
}

void KeyScans::setPoses(const std::vector<Pose2>& map_from_laser) {
  for (std::size_t i = 0; i < keys_.size(); ++i) keys_[i].map_from_laser = map_from_laser[i];
}

void KeyScans::setJump(std::size_t jump, std::size_t key, const Pose2& map_from_laser) {
  keys_[jump].is_jump = true;
  keys_[jump].is_start = false;
  aligned_motion_[jump - 1] = givenEdge(jump);
  const Pose2 shift = map_from_laser * keys_[key].map_from_laser.inverse();
  for (std::size_t i = jump; i < keys_.size(); ++i)
    keys_[i].map_from_laser = shift * keys_[i].map_from_laser;
}

std::vector<StampedPose2> KeyScans::trajectory() const {
  std::vector<StampedPose2> poses;
  poses.reserve(scans_.size());
  for (const ScanRecord& scan : scans_)
    poses.push_back({scan.stamp_ns, poseByKeyScans(scan) * scan.shift});
  return poses;
}

}  // namespace ram_slam
