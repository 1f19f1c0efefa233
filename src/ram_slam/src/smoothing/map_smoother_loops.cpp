// SPDX-License-Identifier: BSD-3-Clause
// The search for loops.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "ram_slam/smoothing/map_smoother.hpp"

namespace ram_slam {
namespace {

constexpr double kClosurePathM = 0.5;        // a closure is as good as so much path
constexpr double kConstellationStepM = 5.0;  // between two searches
constexpr std::size_t kVerifiedCandidates = 3;
constexpr double kSolveBeyondM =
    0.1;  // a closure that moves the newest pose by more is solved for at once
constexpr double kSolveBeyondRad = 0.03;
constexpr double kCorrectionM = 0.03;  // a smaller motion of the newest pose is none
constexpr double kCorrectionRad = 0.01;
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

}  // namespace

bool MapSmoother::isSettled(std::size_t from, std::size_t to) const {
  return std::any_of(closures_.begin(), closures_.end(), [&](const LoopClosure& closure) {
    if (closure.state == ClosureState::kOutvoted) return false;
    const std::size_t reach =
        closure.state == ClosureState::kRefused ? kRefusedKeys : kAcceptedKeys;
    return distance(closure.edge.from, from) <= reach && distance(closure.edge.to, to) <= reach;
  });
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
    const SearchWindow window = searchWindow(paths_m[candidate], parameters_.loops);
    const Pose2 from_from_to = relativePose(candidate, newest);
    if (tryClosing(candidate, newest, key_scans_[newest].map_from_laser, window)) {
      found = true;
    } else {
      failed_searches_.push_back({candidate, newest, from_from_to, window});
    }
  }
  return found || (!is_sweep && searchConstellation(newest));
}

bool MapSmoother::searchConstellation(std::size_t newest) {
  const double path_m = key_scans_[newest].path_m;
  const double wait_m = parameters_.loop_constellation_path_m;
  if (wait_m == 0.0 || path_m - closed_path_m_ < wait_m) return false;
  closed_path_m_ = path_m - wait_m + kConstellationStepM;
  const auto place = constellations_.findPlace(key_scans_, wait_m);
  if (!place) return false;
  const Pose2 map_from_laser = *place * key_scans_[newest].base_from_laser;
  const Eigen::Vector2d view = map_from_laser * key_scans_[newest].view_centre_in_laser_m;
  std::size_t candidate = 0;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; key_scans_[i].path_m <= path_m - wait_m; ++i) {
    const KeyScan& key = key_scans_[i];
    const double away_m = (key.map_from_laser * key.view_centre_in_laser_m - view).norm();
    if (away_m >= least_m) continue;
    candidate = i;
    least_m = away_m;
  }
  return least_m <= parameters_.loops.max_view_distance_m && !isSettled(candidate, newest) &&
         tryClosing(candidate, newest, map_from_laser, searchWindow(0.0, parameters_.loops));
}

bool MapSmoother::tryClosing(std::size_t candidate,
                             std::size_t newest,
                             const Pose2& map_from_laser_guess,
                             const SearchWindow& window) {
  const auto match = verifyLoop(key_scans_, candidate, newest, map_from_laser_guess, window,
                                parameters_.matcher, parameters_.loops);
  if (!match) return false;
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
  closed_path_m_ = std::max(closed_path_m_, key_scans_[newest].path_m);
  if (closure.correction_m > kSolveBeyondM || std::abs(correction.yaw_rad) > kSolveBeyondRad) {
    const Pose2 before = key_scans_[newest].map_from_laser;
    solveGraph();
    const Pose2 moved = before.inverse() * key_scans_[newest].map_from_laser;
    if (moved.translation().norm() > kCorrectionM || std::abs(moved.yaw_rad) > kCorrectionRad)
      has_correction_ = true;
  }
  return true;
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

}  // namespace ram_slam
