// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/loop_closer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"
#include "ram_slam/smoothing/graph_paths.hpp"

namespace ram_slam {
namespace {

std::size_t distance(std::size_t a, std::size_t b) {
  return a > b ? a - b : b - a;
}

}  // namespace

const ram_parameters::ParameterTable<LoopCloserParameters>& LoopCloserParameters::table() {
  using namespace ram_parameters;
  using P = LoopCloserParameters;
  static const auto table =
      ParameterTable<P>()
          .heading("Closures beyond what the noise of the scans explains, as the views differ more")
          .add("closure_deviation_m", &P::closure_deviation_m, "m", positive(),
               "Standard deviation of the position, per axis.")
          .add("closure_deviation_rad", &P::closure_deviation_rad, "rad", positive(),
               "Standard deviation of the heading.")
          .heading("Search for loops")
          .add("loop_search_distance_m", &P::search_distance_m, "m", positive(),
               "Path between two searches.")
          .add("loop_constellation_path_m", &P::constellation_path_m, "m", atLeast(0.0),
               "After so much path without a closure, features recognise places, too; 0: never.")
          .include(&P::search, LoopSearchParameters::table(), "loop_")
          .expert("When and where loops are searched")
          .add("loop_closure_path_m", &P::closure_path_m, "m", atLeast(0.0),
               "Path that a closure is as good as, where the shortest way is sought.")
          .add("loop_verified_candidates", &P::verified_candidates, "", atLeast(1),
               "Most candidates of one key scan that are verified.")
          .add("loop_constellation_step_m", &P::constellation_step_m, "m", atLeast(0.0),
               "Path between two searches by features.")
          .add("loop_constellation_stretch_m", &P::constellation_stretch_m, "m", positive(),
               "Path whose features are compared with those of earlier stretches.")
          .add("loop_kept_feature_lists", &P::kept_feature_lists, "", atLeast(1),
               "Feature lists that are kept until the scan of their stamp comes.")
          .add("loop_refused_reach", &P::refused_reach, "", atLeast(0),
               "Key scans beside a refused closure between which it is not searched again.")
          .add("loop_accepted_reach", &P::accepted_reach, "", atLeast(0),
               "The same of an accepted closure.")
          .add("loop_failed_reach", &P::failed_reach, "", atLeast(0),
               "The same of a search that failed, if it covers the window of the new one.")
          .add("loop_failed_margin_m", &P::failed_margin_m, "m", atLeast(0.0),
               "By how much the new window may reach beyond it.")
          .add("loop_failed_margin_rad", &P::failed_margin_rad, "rad", atLeast(0.0),
               "By how much the new window may be turned beyond it.")
          .add("loop_sweep_path_m", &P::sweep_path_m, "m", positive(),
               "Path along which poses may still have drifted once all loops found are closed.")
          .expert("Search for jumps")
          .include(&P::jumps, JumpSearchParameters::table(), "loop_jump_");
  return table;
}

LoopCloser::LoopCloser(const LoopCloserParameters& parameters,
                       const ScanMatcherParameters& matcher,
                       const FeatureMatchers& matchers)
    : parameters_(parameters),
      matcher_(matcher),
      jumps_(parameters.jumps, parameters.search, matcher),
      constellations_(matchers, parameters.constellation_stretch_m) {}

void LoopCloser::addFeatures(const FeatureList& list) {
  if (parameters_.constellation_path_m == 0.0) return;  // they are not used
  const auto later =
      std::find_if(features_.begin(), features_.end(),
                   [&list](const FeatureList& other) { return other.stamp_ns > list.stamp_ns; });
  features_.insert(later, list);
  if (features_.size() > static_cast<std::size_t>(parameters_.kept_feature_lists))
    features_.pop_front();
}

void LoopCloser::useFeatures(const std::vector<KeyScan>& key_scans) {
  if (key_scans.empty()) return;
  const KeyScan& key = key_scans.back();
  while (!features_.empty() && features_.front().stamp_ns < key.stamp_ns) features_.pop_front();
  if (features_.empty() || features_.front().stamp_ns != key.stamp_ns) return;
  constellations_.add(features_.front(), key_scans, key.odom_from_base());
  features_.pop_front();
}

void LoopCloser::searchIfDue(const std::vector<KeyScan>& key_scans,
                             const ClosureHandler& on_closure) {
  const std::size_t newest = key_scans.size() - 1;
  if (key_scans[newest].path_m - searched_path_m_ < parameters_.search_distance_m) return;
  const bool found =
      searchByPoses(key_scans, newest, std::numeric_limits<double>::infinity(), false, on_closure);
  if (found || searchByShape(key_scans, on_closure)) return;
  searchByFeatures(key_scans, on_closure);
}

bool LoopCloser::sweep(const std::vector<KeyScan>& key_scans, const ClosureHandler& on_closure) {
  bool found = false;
  double searched_path_m = 0.0;
  for (std::size_t key = 0; key < key_scans.size(); ++key) {
    if (key_scans[key].is_loaded ||
        key_scans[key].path_m - searched_path_m < parameters_.search_distance_m)
      continue;
    searched_path_m = key_scans[key].path_m;
    found = searchByPoses(key_scans, key, parameters_.sweep_path_m, true, on_closure) || found;
  }
  return found;
}

bool LoopCloser::searchByPoses(const std::vector<KeyScan>& key_scans,
                               std::size_t newest,
                               double max_path_m,
                               bool is_sweep,
                               const ClosureHandler& on_closure) {
  searched_path_m_ = key_scans[newest].path_m;
  std::vector<double> paths_m = pathsTo(newest, key_scans);
  for (double& path_m : paths_m) {
    if (!std::isinf(path_m)) path_m = std::min(path_m, max_path_m);
  }
  std::vector<std::size_t> candidates =
      findLoopCandidates(key_scans, newest, paths_m, parameters_.search);
  const auto most = static_cast<std::size_t>(parameters_.verified_candidates);
  if (candidates.size() > most) candidates.resize(most);
  bool found = false;
  for (const std::size_t candidate : candidates) {
    if (isSettled(candidate, newest)) continue;
    const SearchWindow window = searchWindow(paths_m[candidate], parameters_.search);
    if (is_sweep && wasSearched(key_scans, candidate, newest, window)) continue;
    PoseEdge centre;
    centre.from = candidate;
    centre.to = newest;
    centre.from_from_to = relativePose(key_scans[candidate], key_scans[newest]);
    const LoopQuery query{candidate, newest, key_scans[newest].map_from_laser, window};
    if (tryClosing(key_scans, query, on_closure)) {
      found = true;
    } else {
      failed_searches_.push_back({centre, window});
    }
  }
  return found;
}

void LoopCloser::searchByFeatures(const std::vector<KeyScan>& key_scans,
                                  const ClosureHandler& on_closure) {
  const std::size_t newest = key_scans.size() - 1;
  const double path_m = key_scans[newest].path_m;
  const double wait_m = parameters_.constellation_path_m;
  if (wait_m == 0.0 || path_m - closed_path_m_ < wait_m) return;
  closed_path_m_ = path_m - wait_m + parameters_.constellation_step_m;
  const std::optional<Pose2> map_from_base = constellations_.findPlace(key_scans, wait_m);
  if (!map_from_base) return;
  const Pose2 map_from_laser = *map_from_base * key_scans[newest].base_from_laser;
  const Eigen::Vector2d view_m = map_from_laser * key_scans[newest].view_centre_in_laser_m;
  const NearestView nearest = nearestView(key_scans, view_m, path_m - wait_m);
  if (nearest.distance_m > parameters_.search.max_view_distance_m) return;
  if (isSettled(nearest.key, newest)) return;
  const SearchWindow window = searchWindow(0.0, parameters_.search);
  tryClosing(key_scans, {nearest.key, newest, map_from_laser, window}, on_closure);
}

bool LoopCloser::tryClosing(const std::vector<KeyScan>& key_scans,
                            const LoopQuery& query,
                            const ClosureHandler& on_closure) {
  const auto match = verifyLoop(key_scans, query, matcher_, parameters_.search);
  if (!match || wasOutvoted(key_scans, match->edge)) return false;
  addClosure(key_scans, *match, std::nullopt, on_closure);
  return true;
}

void LoopCloser::addClosure(const std::vector<KeyScan>& key_scans,
                            const LoopMatch& match,
                            const std::optional<std::size_t>& jump,
                            const ClosureHandler& on_closure) {
  const KeyScan& old_key = key_scans[match.edge.from];
  const KeyScan& new_key = key_scans[match.edge.to];
  const Pose2 wanted = old_key.map_from_laser * match.edge.from_from_to;
  const Pose2 correction = new_key.map_from_laser.inverse() * wanted;
  LoopClosure closure;
  closure.old_stamp_ns = old_key.stamp_ns;
  closure.new_stamp_ns = new_key.stamp_ns;
  closure.edge = match.edge;
  closure.edge.information = withFloor(closure.edge.information, parameters_.closure_deviation_m,
                                       parameters_.closure_deviation_rad);
  closure.score = match.score;
  closure.inlier_ratio = match.inlier_ratio;
  closure.is_ambiguous = match.is_ambiguous;
  closure.correction_m = correction.translation().norm();
  closure.jump = jump;
  closures_.push_back(closure);
  closed_path_m_ = std::max(closed_path_m_, new_key.path_m);
  on_closure(match.edge.to, correction);
}

bool LoopCloser::searchByShape(const std::vector<KeyScan>& key_scans,
                               const ClosureHandler& on_closure) {
  const std::optional<std::size_t> jump = jumps_.possibleJump(key_scans, closures_);
  if (!jump) return false;
  const std::size_t newest = key_scans.size() - 1;
  for (const std::size_t place : jumps_.alikePlaces(key_scans, *jump)) {
    if (isSettled(place, newest)) continue;
    const SearchWindow window{parameters_.search.max_view_distance_m, M_PI,
                              parameters_.search.dense.angle_step_rad};
    const LoopQuery query{place, newest, key_scans[place].map_from_laser, window};
    const auto match = verifyLoop(key_scans, query, matcher_, parameters_.search);
    if (!match || match->is_ambiguous || wasOutvoted(key_scans, match->edge)) continue;
    const bool agrees = agreesWithPoses(key_scans, *match);
    if (!agrees && !jumps_.isShownBy(key_scans, *match, *jump)) continue;
    addClosure(key_scans, *match, agrees ? std::nullopt : jump, on_closure);
    return true;
  }
  return false;
}

bool LoopCloser::agreesWithPoses(const std::vector<KeyScan>& key_scans,
                                 const LoopMatch& match) const {
  const double path_m = pathsTo(match.edge.to, key_scans)[match.edge.from];
  const SearchWindow window = searchWindow(path_m, parameters_.search);
  const MotionGate same{window.distance_m, window.angle_rad};
  const Pose2 by_poses = relativePose(key_scans[match.edge.from], key_scans[match.edge.to]);
  return !same.isExceededBy(by_poses.inverse() * match.edge.from_from_to);
}

bool LoopCloser::isSettled(std::size_t from, std::size_t to) const {
  return std::any_of(closures_.begin(), closures_.end(), [&](const LoopClosure& closure) {
    if (closure.state == ClosureState::kOutvoted) return false;
    const auto reach = static_cast<std::size_t>(closure.state == ClosureState::kRefused
                                                    ? parameters_.refused_reach
                                                    : parameters_.accepted_reach);
    return distance(closure.edge.from, from) <= reach && distance(closure.edge.to, to) <= reach;
  });
}

bool LoopCloser::wasSearched(const std::vector<KeyScan>& key_scans,
                             std::size_t from,
                             std::size_t to,
                             const SearchWindow& window) const {
  const auto reach = static_cast<std::size_t>(parameters_.failed_reach);
  return std::any_of(failed_searches_.begin(), failed_searches_.end(), [&](const auto& failed) {
    const PoseEdge& centre = failed.centre;
    if (distance(centre.from, from) > reach || distance(centre.to, to) > reach) return false;
    // What was searched then, seen from these two key scans.
    const Pose2 searched = relativePoseBy(centre, key_scans, from, to);
    const Pose2 shift = searched.inverse() * relativePose(key_scans[from], key_scans[to]);
    return shift.translation().norm() + window.distance_m <=
               failed.window.distance_m + parameters_.failed_margin_m &&
           std::abs(shift.yaw_rad) + window.angle_rad <=
               failed.window.angle_rad + parameters_.failed_margin_rad;
  });
}

bool LoopCloser::wasOutvoted(const std::vector<KeyScan>& key_scans, const PoseEdge& edge) const {
  const auto reach = static_cast<std::size_t>(parameters_.accepted_reach);
  const MotionGate same{parameters_.failed_margin_m, parameters_.failed_margin_rad};
  return std::any_of(closures_.begin(), closures_.end(), [&](const LoopClosure& closure) {
    const PoseEdge& other = closure.edge;
    if (closure.state != ClosureState::kOutvoted) return false;
    if (distance(other.from, edge.from) > reach || distance(other.to, edge.to) > reach)
      return false;
    const Pose2 by_other = relativePoseBy(other, key_scans, edge.from, edge.to);
    return !same.isExceededBy(by_other.inverse() * edge.from_from_to);
  });
}

std::vector<double> LoopCloser::pathsTo(std::size_t key,
                                        const std::vector<KeyScan>& key_scans) const {
  Shortcuts shortcuts;
  for (const LoopClosure& closure : closures_) {
    if (closure.state == ClosureState::kAccepted && !closure.is_ambiguous)
      shortcuts.emplace_back(closure.edge.from, closure.edge.to);
  }
  return pathLengthsTo(key, key_scans, shortcuts, parameters_.closure_path_m);
}

void LoopCloser::refuse(std::size_t index) {
  closures_.at(index).state = ClosureState::kRefused;
}

void LoopCloser::accept(std::size_t index) {
  closures_.at(index).state = ClosureState::kAccepted;
}

std::vector<PoseEdge> LoopCloser::acceptedEdges() const {
  std::vector<PoseEdge> edges;
  for (const LoopClosure& closure : closures_) {
    if (closure.state == ClosureState::kAccepted) edges.push_back(closure.edge);
  }
  return edges;
}

std::vector<PoseEdge> LoopCloser::candidateEdges() const {
  std::vector<PoseEdge> edges;
  for (const LoopClosure& closure : closures_) {
    if (closure.state == ClosureState::kRefused) continue;
    edges.push_back(closure.edge);
    edges.back().was_outvoted = closure.state == ClosureState::kOutvoted;
  }
  return edges;
}

void LoopCloser::judge(const std::vector<double>& trust, double min_trust) {
  std::size_t edge = 0;
  for (LoopClosure& closure : closures_) {
    if (closure.state == ClosureState::kRefused) continue;
    closure.state =
        trust.at(edge++) < min_trust ? ClosureState::kOutvoted : ClosureState::kAccepted;
  }
}

}  // namespace ram_slam
