// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/jump_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<JumpSearchParameters>& JumpSearchParameters::table() {
  using namespace ram_parameters;
  using P = JumpSearchParameters;
  static const auto table =
      ParameterTable<P>()
          .add("search_path_m", &P::search_path_m, "m", atLeast(0.0),
               "Path after a possible jump along which it is searched for; 0: never.")
          .add("place_count", &P::place_count, "", atLeast(1),
               "Places of the same shape that a key scan is compared with, at most.")
          .add("place_distance_m", &P::place_distance_m, "m", positive(),
               "Least path between two of these.")
          .add("support_path_m", &P::support_path_m, "m", atLeast(0.0),
               "Path between two places that must agree on where the robot was carried.")
          .add("check_path_m", &P::check_path_m, "m", positive(),
               "Path between two key scans since the jump that are compared with what was seen "
               "before, ...")
          .add("min_fitting", &P::min_fitting, "", within(0.0, 1.0),
               "... and the share of them that must fit.");
  return table;
}

JumpSearch::JumpSearch(const JumpSearchParameters& parameters,
                       const LoopSearchParameters& loops,
                       const ScanMatcherParameters& matcher)
    : parameters_(parameters), loops_(loops), matcher_(matcher) {}

std::optional<std::size_t> JumpSearch::possibleJump(
    const std::vector<KeyScan>& key_scans, const std::vector<LoopClosure>& closures) const {
  const double newest_path_m = key_scans.back().path_m;
  std::size_t jump = key_scans.size() - 1;
  while (jump > 0 && !(key_scans[jump].may_be_jump && !key_scans[jump].is_jump)) --jump;
  if (jump == 0 || newest_path_m - key_scans[jump].path_m > parameters_.search_path_m)
    return std::nullopt;
  std::optional<double> confirmed_path_m;  // by a first closure
  for (const LoopClosure& closure : closures) {
    if (closure.state != ClosureState::kAccepted || closure.is_ambiguous) continue;
    if (closure.edge.from >= jump || closure.edge.to < jump) continue;
    const double path_m = key_scans[closure.edge.to].path_m;
    if (!confirmed_path_m) confirmed_path_m = path_m;
    if (std::abs(path_m - *confirmed_path_m) >= parameters_.support_path_m) return std::nullopt;
  }
  // The key scans about the newest one must all be of its side of the jump.
  const std::size_t since = key_scans.size() - 1 - jump;
  if (since < static_cast<std::size_t>(loops_.neighbour_count)) return std::nullopt;
  return jump;
}

std::vector<std::size_t> JumpSearch::alikePlaces(const std::vector<KeyScan>& key_scans,
                                                 std::size_t jump) {
  while (descriptors_.size() < key_scans.size())
    descriptors_.push_back(
        describePlace(key_scans[descriptors_.size()].surfaces, loops_.dense.max_range_m));
  const std::size_t newest = key_scans.size() - 1;
  const auto neighbours = static_cast<std::size_t>(loops_.neighbour_count);
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i + neighbours < jump; ++i)
    ranked.emplace_back(-likeness(descriptors_[i], descriptors_[newest]), i);
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> places;
  for (const auto& candidate : ranked) {
    const std::size_t place = candidate.second;
    if (places.size() == static_cast<std::size_t>(parameters_.place_count)) break;
    const bool is_other = std::all_of(places.begin(), places.end(), [&](std::size_t other) {
      return std::abs(key_scans[place].path_m - key_scans[other].path_m) >=
             parameters_.place_distance_m;
    });
    if (is_other) places.push_back(place);
  }
  return places;
}

bool JumpSearch::isShownBy(const std::vector<KeyScan>& key_scans,
                           const LoopMatch& match,
                           std::size_t jump) {
  const bool is_supported =
      isWhereFound(key_scans, match, jump) || isSupported(key_scans, match, jump);
  unsupported_.push_back(match);
  return is_supported && fitsSinceJump(key_scans, match, jump);
}

bool JumpSearch::isWhereFound(const std::vector<KeyScan>& key_scans,
                              const LoopMatch& match,
                              std::size_t jump) const {
  if (!found_ || found_->stamp_ns < key_scans[jump].stamp_ns) return false;
  const auto found_at =
      std::find_if(key_scans.begin() + static_cast<std::ptrdiff_t>(jump), key_scans.end(),
                   [this](const KeyScan& key) { return key.stamp_ns >= found_->stamp_ns; });
  if (found_at == key_scans.end()) return false;
  const KeyScan& newer = key_scans[match.edge.to];
  const SearchWindow window = searchWindow(std::abs(newer.path_m - found_at->path_m), loops_);
  const MotionGate same{window.distance_m, window.angle_rad};
  const Pose2 by_match = key_scans[match.edge.from].map_from_laser * match.edge.from_from_to;
  const Pose2 by_estimator = found_->map_from_odom * newer.odom_from_laser;
  return !same.isExceededBy(by_estimator.inverse() * by_match);
}

bool JumpSearch::isSupported(const std::vector<KeyScan>& key_scans,
                             const LoopMatch& match,
                             std::size_t jump) const {
  return std::any_of(unsupported_.begin(), unsupported_.end(), [&](const LoopMatch& other) {
    if (other.edge.from >= jump || other.edge.to < jump) return false;
    const double new_path_m =
        std::abs(key_scans[match.edge.to].path_m - key_scans[other.edge.to].path_m);
    const double old_path_m =
        std::abs(key_scans[match.edge.from].path_m - key_scans[other.edge.from].path_m);
    if (new_path_m < parameters_.support_path_m) return false;
    const Pose2 by_other = relativePoseBy(other.edge, key_scans, match.edge.from, match.edge.to);
    const SearchWindow window = searchWindow(new_path_m + old_path_m, loops_);
    const MotionGate same{window.distance_m, window.angle_rad};
    return !same.isExceededBy(by_other.inverse() * match.edge.from_from_to);
  });
}

bool JumpSearch::fitsSinceJump(const std::vector<KeyScan>& key_scans,
                               const LoopMatch& match,
                               std::size_t jump) const {
  const Pose2 moved = key_scans[match.edge.from].map_from_laser * match.edge.from_from_to *
                      key_scans[match.edge.to].map_from_laser.inverse();
  const double last_path_m = key_scans[jump - 1].path_m;
  double checked_path_m = key_scans[jump].path_m;
  int checked = 0;
  int fitting = 0;
  for (std::size_t key = jump + 1; key < key_scans.size(); ++key) {
    if (key_scans[key].path_m - checked_path_m < parameters_.check_path_m) continue;
    checked_path_m = key_scans[key].path_m;
    const Pose2 map_from_laser = moved * key_scans[key].map_from_laser;
    const NearestView nearest =
        nearestView(key_scans, map_from_laser * key_scans[key].view_centre_in_laser_m, last_path_m);
    if (nearest.distance_m > loops_.max_view_distance_m) continue;
    ++checked;
    const double path_m = std::abs(key_scans[match.edge.to].path_m - checked_path_m);
    const LoopQuery query{nearest.key, key, map_from_laser, searchWindow(path_m, loops_)};
    if (verifyLoop(key_scans, query, matcher_, loops_)) ++fitting;
  }
  return fitting >= parameters_.min_fitting * checked;
}

}  // namespace ram_slam
