// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace ram_slam {
namespace {

constexpr double kViewRangeM = 8.0;       // what lies farther does not say where a scan looks
constexpr double kMetresPerRadian = 0.5;  // turning counts as path: odometry drifts by it, too
constexpr double kMinTrust = 0.5;
constexpr std::size_t kKeptLists = 100;
// Of the scans between two key scans those are aligned, too, between which so much motion lies.
constexpr double kBetweenM = 0.05;
constexpr double kBetweenRad = 0.05;
constexpr std::size_t kBetweenReferences = 3;  // the newest key scans
constexpr std::size_t kFarthestBack = 4;  // key scans that a new one is aligned with: 1, 2, 4 back
Eigen::Vector2d viewCentre(const SurfaceScan& surfaces) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (const SurfacePoint& point : surfaces.points) {
    const Eigen::Vector2d place(point.x_m, point.y_m);
    if (place.norm() > kViewRangeM) continue;
    sum += place;
    count += 1.0;
  }
  return count > 0.0 ? Eigen::Vector2d(sum / count) : sum;
}

/// The given pose of the base at a key scan.
Pose2 odomFromBase(const Pose2& odom_from_laser, const KeyScan& key) {
  return odom_from_laser * key.base_from_laser.inverse();
}

bool isFarther(const Pose2& motion, double distance_m, double angle_rad) {
  return motion.translation().norm() >= distance_m || std::abs(motion.yaw_rad) >= angle_rad;
}

/// Of a motion as it is given, in the axes of its start.
Eigen::Matrix3d informationOf(const Pose2& motion, const MapSmootherParameters& parameters) {
  const double distance_m = motion.translation().norm();
  const double deviation_m =
      parameters.motion_rest_deviation_m + parameters.motion_deviation_m_per_m * distance_m;
  const double deviation_rad = parameters.motion_rest_deviation_rad +
                               parameters.motion_deviation_rad_per_m * distance_m +
                               parameters.motion_deviation_rad_per_rad * std::abs(motion.yaw_rad);
  const Eigen::Vector3d deviations(deviation_m, deviation_m, deviation_rad);
  return deviations.cwiseAbs2().cwiseInverse().asDiagonal();
}

}  // namespace

MapSmoother::MapSmoother(const MapSmootherParameters& parameters, const FeatureMatchers& matchers)
    : parameters_(parameters), constellations_(matchers) {
  parameters_.validate();
}

void MapSmoother::addScan(const LaserScan& scan,
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
  const bool is_key = key_scans_.empty() || isKeyScan(odom_from_base);
  if (is_key || isBetweenScan(odom_from_base)) {
    Pose2 last_beam;
    if (!scans_.empty()) {
      const Pose2 motion = scans_.back().odom_from_base.inverse() * odom_from_base;
      last_beam = continued(base_from_laser.inverse() * motion * base_from_laser,
                            scan.stamp_ns - scans_.back().stamp_ns, scan.duration_ns());
    }
    SurfaceScan surfaces = extractSurfaces(scan, parameters_.surfaces, last_beam);
    if (is_key) {
      addKeyScan(scan.stamp_ns, std::move(surfaces), base_from_laser, odom_from_base);
    } else {
      between_scans_.push_back({scans_.size(), std::move(surfaces), base_from_laser});
    }
  }
  scans_.push_back({scan.stamp_ns, key_scans_.size() - 1, odom_from_base});
  if (is_key) useFeatures();
  if (is_key && key_scans_.back().path_m - searched_path_m_ >= parameters_.loop_search_distance_m)
    searchLoops(key_scans_.size() - 1, std::numeric_limits<double>::infinity());
}

void MapSmoother::addFeatures(const FeatureList& list) {
  if (parameters_.loop_constellation_path_m == 0.0) return;  // nobody will ask for them
  const auto later =
      std::find_if(features_.begin(), features_.end(),
                   [&list](const FeatureList& other) { return other.stamp_ns > list.stamp_ns; });
  features_.insert(later, list);
  if (features_.size() > kKeptLists) features_.pop_front();
  useFeatures();
}

void MapSmoother::useFeatures() {
  if (key_scans_.empty()) return;
  const KeyScan& key = key_scans_.back();
  while (!features_.empty() && features_.front().stamp_ns < key.stamp_ns) features_.pop_front();
  if (features_.empty() || features_.front().stamp_ns != key.stamp_ns) return;
  constellations_.add(features_.front(), key_scans_, odomFromBase(odom_from_laser_.back(), key));
  features_.pop_front();
}

bool MapSmoother::isKeyScan(const Pose2& odom_from_base) const {
  const Pose2 odom_from_key = odomFromBase(odom_from_laser_.back(), key_scans_.back());
  return isFarther(odom_from_key.inverse() * odom_from_base, parameters_.key_scan_distance_m,
                   parameters_.key_scan_angle_rad);
}

bool MapSmoother::isBetweenScan(const Pose2& odom_from_base) const {
  const Pose2 odom_from_last = between_scans_.empty()
                                   ? odomFromBase(odom_from_laser_.back(), key_scans_.back())
                                   : scans_[between_scans_.back().record].odom_from_base;
  return isFarther(odom_from_last.inverse() * odom_from_base, kBetweenM, kBetweenRad);
}

void MapSmoother::addKeyScan(std::int64_t stamp_ns,
                             SurfaceScan surfaces,
                             const Pose2& base_from_laser,
                             const Pose2& odom_from_base) {
  KeyScan key;
  key.stamp_ns = stamp_ns;
  key.view_centre_in_laser_m = viewCentre(surfaces);
  key.surfaces = std::move(surfaces);
  key.base_from_laser = base_from_laser;
  odom_from_laser_.push_back(odom_from_base * base_from_laser);
  key.map_from_laser = odom_from_laser_.back();
  if (!key_scans_.empty()) {
    const KeyScan& last = key_scans_.back();
    const Pose2 motion =
        odom_from_laser_[odom_from_laser_.size() - 2].inverse() * odom_from_laser_.back();
    key.map_from_laser = last.map_from_laser * motion;
    key.path_m =
        last.path_m + motion.translation().norm() + kMetresPerRadian * std::abs(motion.yaw_rad);
  }
  key_scans_.push_back(std::move(key));
  if (key_scans_.size() == 1) return;

  // The given motion is the prior of an alignment with the scan before.
  PoseEdge edge = motionEdge(key_scans_.size() - 1);
  const KeyScan& last = key_scans_[edge.from];
  const ScanMatch match =
      matchScan(key_scans_.back().surfaces, scansBefore(edge.to),
                {edge.from_from_to, edge.information}, edge.from_from_to, parameters_.matcher);
  edge.from_from_to = match.map_from_laser;
  edge.information = withFloor(edge.information + match.information, parameters_.match_deviation_m,
                               parameters_.match_deviation_rad);
  motion_.push_back(edge);
  key_scans_.back().map_from_laser = last.map_from_laser * edge.from_from_to;
  alignBetweenScans();
}

std::vector<ReferenceScan> MapSmoother::scansBefore(std::size_t key) const {
  std::vector<ReferenceScan> references;
  for (std::size_t back = 1; back <= std::min(key, kFarthestBack); back *= 2)
    references.push_back({&key_scans_[key - back].surfaces, relativePose(key - 1, key - back)});
  return references;
}

PoseEdge MapSmoother::motionEdge(std::size_t to) const {
  PoseEdge edge;
  edge.from = to - 1;
  edge.to = to;
  edge.from_from_to = odom_from_laser_[to - 1].inverse() * odom_from_laser_[to];
  edge.information = informationOf(edge.from_from_to, parameters_);
  return edge;
}

void MapSmoother::alignBetweenScans() {
  if (between_scans_.empty()) return;
  std::vector<ReferenceScan> references;
  for (std::size_t key = key_scans_.size() - std::min(key_scans_.size(), kBetweenReferences);
       key < key_scans_.size(); ++key) {
    references.push_back({&key_scans_[key].surfaces, key_scans_[key].map_from_laser});
  }
  const std::size_t key = key_scans_.size() - 2;
  for (const BetweenScan& between : between_scans_) {
    ScanRecord& scan = scans_[between.record];
    const Pose2 expected = poseByKeyScans(scan) * between.base_from_laser;
    const Pose2 motion =
        odom_from_laser_[key].inverse() * scan.odom_from_base * between.base_from_laser;
    const ScanMatch match =
        matchScan(between.surfaces, references, {expected, informationOf(motion, parameters_)},
                  expected, parameters_.matcher);
    if (match.inlier_ratio < parameters_.refinement.min_inlier_ratio) continue;
    const Pose2 shift = expected.inverse() * match.map_from_laser;
    scan.shift = between.base_from_laser * shift * between.base_from_laser.inverse();
  }
  shareShifts(key_scans_[key].stamp_ns, key_scans_.back().stamp_ns);
  between_scans_.clear();
}

void MapSmoother::shareShifts(std::int64_t from_ns, std::int64_t to_ns) {
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

Pose2 MapSmoother::relativePose(std::size_t from, std::size_t to) const {
  return key_scans_[from].map_from_laser.inverse() * key_scans_[to].map_from_laser;
}

PoseGraph MapSmoother::laserGraph() const {
  PoseGraph graph;
  for (const KeyScan& key : key_scans_) graph.map_from_node.push_back(key.map_from_laser);
  graph.edges = motion_;
  for (const LoopClosure& closure : closures_) {
    if (closure.state == ClosureState::kAccepted) graph.edges.push_back(closure.edge);
  }
  return graph;
}

void MapSmoother::solveGraph() {
  const PoseGraphSolution solution = solvePoseGraph(laserGraph(), parameters_.graph);
  for (std::size_t i = 0; i < key_scans_.size(); ++i)
    key_scans_[i].map_from_laser = solution.map_from_node[i];
  std::size_t edge = motion_.size();
  for (LoopClosure& closure : closures_) {
    if (closure.state != ClosureState::kAccepted) continue;
    if (solution.edge_trust[edge++] < kMinTrust) closure.state = ClosureState::kOutvoted;
  }
}

void MapSmoother::optimize() {
  if (key_scans_.empty()) return;
  solveGraph();
  sweepLoops();
  std::vector<PoseEdge> priors;
  for (std::size_t to = 1; to < key_scans_.size(); ++to) priors.push_back(motionEdge(to));
  const std::vector<Pose2> refined =
      refineJointly(key_scans_, priors, parameters_.matcher, parameters_.refinement);
  for (std::size_t i = 0; i < key_scans_.size(); ++i) key_scans_[i].map_from_laser = refined[i];
  has_correction_ = true;
  optimized_closures_ = closures_.size();
  optimized_ns_ = scans_.back().stamp_ns;
}

void MapSmoother::optimizeIfDue() {
  if (parameters_.optimize_period_s == 0.0) return;
  const auto period_ns = static_cast<std::int64_t>(parameters_.optimize_period_s * 1e9);
  if (scans_.empty() || scans_.back().stamp_ns < optimized_ns_ + period_ns) return;
  // Not at the first closure of a place: those that follow it make the solution better.
  optimized_ns_ = scans_.back().stamp_ns;
  if (closures_.size() != optimized_closures_) optimize();
}

std::vector<StampedPose2> MapSmoother::takeCorrection() {
  has_correction_ = false;
  return trajectory();
}

std::vector<StampedPose2> MapSmoother::trajectory() const {
  std::vector<StampedPose2> poses;
  poses.reserve(scans_.size());
  for (const ScanRecord& scan : scans_)
    poses.push_back({scan.stamp_ns, poseByKeyScans(scan) * scan.shift});
  return poses;
}

Pose2 MapSmoother::poseByKeyScans(const ScanRecord& scan) const {
  // It keeps its place relative to each of the two, each by the share of the other's path.
  const auto corrected = [&](std::size_t key) {
    const Pose2 key_laser_from_base = odom_from_laser_[key].inverse() * scan.odom_from_base;
    return key_scans_[key].map_from_laser * key_laser_from_base;
  };
  const Pose2 pose = corrected(scan.key);
  if (scan.key + 1 == key_scans_.size() || scan.stamp_ns == key_scans_[scan.key].stamp_ns)
    return pose;
  const auto since = static_cast<double>(scan.stamp_ns - key_scans_[scan.key].stamp_ns);
  const auto interval =
      static_cast<double>(key_scans_[scan.key + 1].stamp_ns - key_scans_[scan.key].stamp_ns);
  return interpolate(pose, corrected(scan.key + 1), since / interval);
}

void MapSmoother::refuseClosure(std::size_t index) {
  closures_.at(index).state = ClosureState::kRefused;
}

void MapSmoother::acceptClosure(std::size_t index) {
  closures_.at(index).state = ClosureState::kAccepted;
}

PoseGraph MapSmoother::graph() const {
  PoseGraph graph = laserGraph();
  for (std::size_t i = 0; i < key_scans_.size(); ++i)
    graph.map_from_node[i] = key_scans_[i].map_from_base();
  for (PoseEdge& edge : graph.edges) {
    edge.from_from_to = key_scans_[edge.from].base_from_laser * edge.from_from_to *
                        key_scans_[edge.to].base_from_laser.inverse();
    Eigen::Matrix3d base_axes = Eigen::Matrix3d::Identity();
    base_axes.topLeftCorner<2, 2>() = key_scans_[edge.from].base_from_laser.rotation();
    edge.information = base_axes * edge.information * base_axes.transpose();
  }
  return graph;
}

}  // namespace ram_slam
