// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/map_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/LU>

namespace ram_slam {
namespace {

constexpr double kViewRangeM = 8.0;       // what lies farther does not say where a scan looks
constexpr double kMetresPerRadian = 0.5;  // turning counts as path: odometry drifts by it, too
constexpr double kClosurePathM = 0.5;     // a closure is as good as so much path
constexpr std::size_t kVerifiedCandidates = 3;
constexpr double kSolveBeyondM =
    0.1;  // a closure that moves the newest pose by more is solved for at once
constexpr double kSolveBeyondRad = 0.03;
constexpr double kCorrectionM = 0.03;  // a smaller motion of the newest pose is none
constexpr double kCorrectionRad = 0.01;
constexpr double kMinTrust = 0.5;
constexpr std::size_t kFarthestBack = 4;  // key scans that a new one is aligned with: 1, 2, 4 back
// A closure is not searched for again so many key scans beside one that is known.
constexpr std::size_t kRefusedKeys = 10;
constexpr std::size_t kAcceptedKeys = 4;
// Nor a search that failed, so many key scans beside it, in a window that it covers but for these.
constexpr std::size_t kFailedKeys = 2;
constexpr double kSearchMarginM = 0.25;
constexpr double kSearchMarginRad = 0.05;
constexpr int kMaxSweeps = 2;
constexpr double kSweepPathM =
    30.0;  // once all loops found are closed, no pose has drifted by more path than this

std::size_t distance(std::size_t a, std::size_t b) {
  return a > b ? a - b : b - a;
}

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

/// (C + D)^-1 for D = diag(deviations^2), from C^-1, which may be singular: walls leave directions
/// open.
Eigen::Matrix3d withFloor(const Eigen::Matrix3d& information,
                          double deviation_m,
                          double deviation_rad) {
  const Eigen::Vector3d deviations(deviation_m, deviation_m, deviation_rad);
  const Eigen::Matrix3d floor = deviations.cwiseAbs2().asDiagonal();
  return information * (Eigen::Matrix3d::Identity() + floor * information).inverse();
}

}  // namespace

MapSmoother::MapSmoother(const MapSmootherParameters& parameters) : parameters_(parameters) {
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
  if (key_scans_.empty() || isKeyScan(odom_from_base)) {
    Pose2 last_beam;
    if (!scans_.empty()) {
      const Pose2 motion = scans_.back().odom_from_base.inverse() * odom_from_base;
      last_beam = continued(base_from_laser.inverse() * motion * base_from_laser,
                            scan.stamp_ns - scans_.back().stamp_ns, scan.duration_ns());
    }
    addKeyScan(scan.stamp_ns, extractSurfaces(scan, parameters_.surfaces, last_beam),
               base_from_laser, odom_from_base);
    if (key_scans_.back().path_m - searched_path_m_ >= parameters_.loop_search_distance_m)
      searchLoops(key_scans_.size() - 1, std::numeric_limits<double>::infinity());
  }
  scans_.push_back({scan.stamp_ns, key_scans_.size() - 1, odom_from_base});
}

bool MapSmoother::isKeyScan(const Pose2& odom_from_base) const {
  const KeyScan& last = key_scans_.back();
  const Pose2 motion =
      (odom_from_laser_.back() * last.base_from_laser.inverse()).inverse() * odom_from_base;
  return motion.translation().norm() >= parameters_.key_scan_distance_m ||
         std::abs(motion.yaw_rad) >= parameters_.key_scan_angle_rad;
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
  const double distance_m = edge.from_from_to.translation().norm();
  const double deviation_m =
      parameters_.motion_rest_deviation_m + parameters_.motion_deviation_m_per_m * distance_m;
  const double deviation_rad =
      parameters_.motion_rest_deviation_rad + parameters_.motion_deviation_rad_per_m * distance_m +
      parameters_.motion_deviation_rad_per_rad * std::abs(edge.from_from_to.yaw_rad);
  edge.information.diagonal() << 1.0 / (deviation_m * deviation_m),
      1.0 / (deviation_m * deviation_m), 1.0 / (deviation_rad * deviation_rad);
  return edge;
}

bool MapSmoother::isSettled(std::size_t from, std::size_t to) const {
  return std::any_of(closures_.begin(), closures_.end(), [&](const LoopClosure& closure) {
    if (closure.state == ClosureState::kOutvoted) return false;
    const std::size_t reach =
        closure.state == ClosureState::kRefused ? kRefusedKeys : kAcceptedKeys;
    return distance(closure.edge.from, from) <= reach && distance(closure.edge.to, to) <= reach;
  });
}

Pose2 MapSmoother::relativePose(std::size_t from, std::size_t to) const {
  return key_scans_[from].map_from_laser.inverse() * key_scans_[to].map_from_laser;
}

bool MapSmoother::wasSearched(std::size_t from, std::size_t to, double path_m) const {
  const SearchWindow window = searchWindow(path_m, parameters_.loops);
  return std::any_of(failed_searches_.begin(), failed_searches_.end(), [&](const auto& failed) {
    if (distance(failed.from, from) > kFailedKeys || distance(failed.to, to) > kFailedKeys)
      return false;
    // What was searched then, seen from these two key scans.
    const Pose2 centre =
        relativePose(from, failed.from) * failed.from_from_to * relativePose(failed.to, to);
    const Pose2 shift = centre.inverse() * relativePose(from, to);
    return shift.translation().norm() + window.distance_m <=
               failed.window.distance_m + kSearchMarginM &&
           std::abs(shift.yaw_rad) + window.angle_rad <= failed.window.angle_rad + kSearchMarginRad;
  });
}

bool MapSmoother::searchLoops(std::size_t newest, double max_path_m) {
  const bool is_sweep = max_path_m < std::numeric_limits<double>::infinity();
  searched_path_m_ = key_scans_[newest].path_m;
  std::vector<double> paths_m = pathsTo(newest);
  for (double& path_m : paths_m) path_m = std::min(path_m, max_path_m);
  std::vector<std::size_t> candidates =
      findLoopCandidates(key_scans_, newest, paths_m, parameters_.loops);
  if (candidates.size() > kVerifiedCandidates) candidates.resize(kVerifiedCandidates);
  bool found = false;
  for (const std::size_t candidate : candidates) {
    if (isSettled(candidate, newest)) continue;
    if (is_sweep && wasSearched(candidate, newest, paths_m[candidate])) continue;
    const auto match = verifyLoop(key_scans_, candidate, newest, paths_m[candidate],
                                  parameters_.matcher, parameters_.loops);
    if (!match) {
      failed_searches_.push_back({candidate, newest, relativePose(candidate, newest),
                                  searchWindow(paths_m[candidate], parameters_.loops)});
      continue;
    }
    const Pose2 wanted = key_scans_[candidate].map_from_laser * match->edge.from_from_to;
    const Pose2 correction = key_scans_[newest].map_from_laser.inverse() * wanted;
    LoopClosure closure;
    closure.old_stamp_ns = key_scans_[candidate].stamp_ns;
    closure.new_stamp_ns = key_scans_[newest].stamp_ns;
    closure.edge = match->edge;
    closure.edge.information = withFloor(closure.edge.information, parameters_.closure_deviation_m,
                                         parameters_.closure_deviation_rad);
    closure.score = match->score;
    closure.inlier_ratio = match->inlier_ratio;
    closure.is_ambiguous = match->is_ambiguous;
    closure.correction_m = correction.translation().norm();
    closures_.push_back(closure);
    if (closure.correction_m > kSolveBeyondM || std::abs(correction.yaw_rad) > kSolveBeyondRad) {
      const Pose2 before = key_scans_[newest].map_from_laser;
      solveGraph();
      const Pose2 moved = before.inverse() * key_scans_[newest].map_from_laser;
      if (moved.translation().norm() > kCorrectionM || std::abs(moved.yaw_rad) > kCorrectionRad)
        ++correction_count_;
    }
    found = true;
  }
  return found;
}

std::vector<double> MapSmoother::pathsTo(std::size_t node_sought) const {
  std::vector<std::pair<std::size_t, std::size_t>> shortcuts;  // both ways, by where they begin
  for (const LoopClosure& closure : closures_) {
    if (closure.state != ClosureState::kAccepted || closure.is_ambiguous) continue;
    shortcuts.emplace_back(closure.edge.from, closure.edge.to);
    shortcuts.emplace_back(closure.edge.to, closure.edge.from);
  }
  std::sort(shortcuts.begin(), shortcuts.end());
  std::vector<double> length_m(key_scans_.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto reach = [&](std::size_t node, double length) {
    if (length >= length_m[node]) return;
    length_m[node] = length;
    queue.emplace(length, node);
  };
  reach(node_sought, 0.0);
  while (!queue.empty()) {
    const auto [length, node] = queue.top();
    queue.pop();
    if (length > length_m[node]) continue;
    const double path_m = key_scans_[node].path_m;
    if (node > 0) reach(node - 1, length + path_m - key_scans_[node - 1].path_m);
    if (node + 1 < key_scans_.size())
      reach(node + 1, length + key_scans_[node + 1].path_m - path_m);
    for (auto way =
             std::lower_bound(shortcuts.begin(), shortcuts.end(), std::pair(node, std::size_t{0}));
         way != shortcuts.end() && way->first == node; ++way) {
      reach(way->second, length + kClosurePathM);
    }
  }
  return length_m;
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

void MapSmoother::sweepLoops() {
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    bool found = false;
    double searched_path_m = 0.0;
    for (std::size_t key = 0; key < key_scans_.size(); ++key) {
      if (key_scans_[key].path_m - searched_path_m < parameters_.loop_search_distance_m) continue;
      searched_path_m = key_scans_[key].path_m;
      found = searchLoops(key, kSweepPathM) || found;
    }
    if (!found) return;
    solveGraph();
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
}

std::vector<StampedPose2> MapSmoother::trajectory() const {
  // A scan keeps its place relative to the key scans before and after it, each by the share of the
  // other's path.
  std::vector<StampedPose2> poses;
  poses.reserve(scans_.size());
  for (const ScanRecord& scan : scans_) {
    const auto corrected = [&](std::size_t key) {
      const Pose2 key_laser_from_base = odom_from_laser_[key].inverse() * scan.odom_from_base;
      return key_scans_[key].map_from_laser * key_laser_from_base;
    };
    Pose2 pose = corrected(scan.key);
    if (scan.key + 1 < key_scans_.size() && scan.stamp_ns > key_scans_[scan.key].stamp_ns) {
      const auto since = static_cast<double>(scan.stamp_ns - key_scans_[scan.key].stamp_ns);
      const auto interval =
          static_cast<double>(key_scans_[scan.key + 1].stamp_ns - key_scans_[scan.key].stamp_ns);
      pose = interpolate(pose, corrected(scan.key + 1), since / interval);
    }
    poses.push_back({scan.stamp_ns, pose});
  }
  return poses;
}

void MapSmoother::refuseClosure(std::size_t index) {
  closures_.at(index).state = ClosureState::kRefused;
}

void MapSmoother::acceptClosure(std::size_t index) {
  closures_.at(index).state = ClosureState::kAccepted;
}

PoseGraph MapSmoother::graph() const {
  PoseGraph graph = laserGraph();
  for (std::size_t i = 0; i < key_scans_.size(); ++i) {
    graph.map_from_node[i] = key_scans_[i].map_from_laser * key_scans_[i].base_from_laser.inverse();
  }
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
