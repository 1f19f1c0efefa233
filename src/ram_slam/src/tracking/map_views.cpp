// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/map_views.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace ram_slam {
namespace {

// Views nearer to each other than this are of one place.
constexpr double kSamePlace_m = 1.0;
constexpr double kSamePlace_rad = 0.8;
constexpr double kFarthest_m = 4.0;  // of places that a view is compared with
constexpr std::size_t kMostCompared = 2;
// Share of contradiction that says nothing: views of one place show less, of two places more.
constexpr double kNeutral = 0.04;
// Of the search around a pose: first steps, and how often they are halved.
constexpr double kStep_m = 0.16;
constexpr double kStep_rad = 0.05;
constexpr int kHalvings = 3;
// Of the search in all of the map.
constexpr double kTile_m = 3.0;
constexpr double kResolution_m = 0.15;
constexpr double kDeviation_m = 0.15;
constexpr int kLevels = 4;
constexpr double kAngleStep_rad = 0.02;
constexpr double kLeastFit = 0.6;
constexpr double kNearBestFit = 0.8;  // of the best one's fit; with less it is no candidate
constexpr std::size_t kMostCandidates = 12;
constexpr std::size_t kMostViews = 12;  // the newest, of the way driven
constexpr std::size_t kMostPoints = 160;

void appendSurfaces(const FieldOfView& view,
                    const Pose2& target_from_base,
                    std::vector<Eigen::Vector2f>& points) {
  const Eigen::Matrix2d rotation = target_from_base.rotation();
  for (const Eigen::Vector2d& point_m : view.surface_m())
    points.push_back((target_from_base.translation() + rotation * point_m).cast<float>());
}

}  // namespace

void MapViews::add(std::int64_t stamp_ns,
                   const Pose2& map_from_base,
                   double path_m,
                   std::shared_ptr<const FieldOfView> view) {
  if (view == nullptr) return;
  const bool known = std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
    const Eigen::Vector2d away_m = place.map_from_base.translation() - map_from_base.translation();
    return away_m.squaredNorm() < kSamePlace_m * kSamePlace_m &&
           std::abs(wrapAngle(map_from_base.yaw_rad - place.map_from_base.yaw_rad)) <
               kSamePlace_rad;
  });
  if (known) return;
  places_.push_back({stamp_ns, map_from_base, std::move(view), path_m});
  surfaces_.reset();
}

void MapViews::clear() {
  places_.clear();
  surfaces_.reset();
}

void MapViews::follow(const Trajectory& path) {
  surfaces_.reset();
  std::vector<Place> kept;
  for (Place& place : places_) {
    const std::optional<Pose2> pose = poseAt(path, place.stamp_ns);
    if (!pose) continue;
    place.map_from_base = *pose;
    kept.push_back(std::move(place));
  }
  places_ = std::move(kept);
}

std::vector<std::size_t> MapViews::near(const Pose2& map_from_base) const {
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const double away_m2 =
        (places_[i].map_from_base.translation() - map_from_base.translation()).squaredNorm();
    if (away_m2 < kFarthest_m * kFarthest_m) by_distance.push_back({away_m2, i});
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<std::size_t> indices;
  for (const auto& [away_m2, index] : by_distance) indices.push_back(index);
  return indices;
}

std::optional<double> MapViews::contradiction(const FieldOfView& view,
                                              const Pose2& map_from_base) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const std::size_t i : near(map_from_base)) {
    const auto share =
        discontinuity(*places_[i].view, view, places_[i].map_from_base.inverse() * map_from_base);
    if (!share) continue;
    sum += *share;
    if (++count == kMostCompared) break;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

std::optional<double> MapViews::watch(const FieldOfView& view,
                                      const Pose2& map_from_base,
                                      double path_m) {
  double sum = 0.0;
  int trusted_count = 0;
  std::size_t count = 0;
  for (const std::size_t i : near(map_from_base)) {
    const auto share =
        discontinuity(*places_[i].view, view, places_[i].map_from_base.inverse() * map_from_base);
    if (!share) continue;
    if (path_m - places_[i].agreed_at_m < kTrustedPath_m) {
      sum += *share;
      ++trusted_count;
    }
    if (*share < kNeutral) places_[i].agreed_at_m = path_m;
    if (++count == kMostCompared) break;
  }
  if (trusted_count == 0) return std::nullopt;
  return sum / trusted_count;
}

void MapViews::trustMap(double path_m) {
  for (Place& place : places_) place.agreed_at_m = path_m;
}

ViewAgreement MapViews::judge(const std::vector<LocalConstellation::PlacedView>& views,
                              const Pose2& map_from_base) const {
  ViewAgreement agreement;
  for (const LocalConstellation::PlacedView& placed : views) {
    const auto share = contradiction(*placed.view, map_from_base * placed.base_from_then);
    if (!share) continue;
    ++agreement.compared_count;
    agreement.contradiction += *share;
    agreement.evidence +=
        std::max(kMostEvidence * (1.0 - *share / kNeutral), -kMostCounterevidence);
  }
  if (agreement.compared_count > 0) agreement.contradiction /= agreement.compared_count;
  return agreement;
}

Pose2 MapViews::refined(const std::vector<LocalConstellation::PlacedView>& views,
                        const Pose2& map_from_base) const {
  Pose2 best = map_from_base;
  ViewAgreement least = judge(views, best);
  double step_m = kStep_m;
  double step_rad = kStep_rad;
  for (int halving = 0; halving < kHalvings;) {
    const Pose2 centre = best;
    bool better = false;
    for (const Pose2& step :
         {Pose2{step_m, 0.0, 0.0}, Pose2{-step_m, 0.0, 0.0}, Pose2{0.0, step_m, 0.0},
          Pose2{0.0, -step_m, 0.0}, Pose2{0.0, 0.0, step_rad}, Pose2{0.0, 0.0, -step_rad}}) {
      const ViewAgreement agreement = judge(views, centre * step);
      if (agreement.compared_count < least.compared_count ||
          agreement.contradiction >= least.contradiction)
        continue;
      least = agreement;
      best = centre * step;
      better = true;
    }
    if (better) continue;
    step_m *= 0.5;
    step_rad *= 0.5;
    ++halving;
  }
  return best;
}

std::vector<Pose2> MapViews::candidates(
    const std::vector<LocalConstellation::PlacedView>& views) const {
  std::vector<Eigen::Vector2f> seen;
  for (std::size_t i = views.size() - std::min(views.size(), kMostViews); i < views.size(); ++i)
    appendSurfaces(*views[i].view, views[i].base_from_then, seen);
  if (!surfaces_) {
    std::vector<Eigen::Vector2f> known;
    for (const Place& place : places_) appendSurfaces(*place.view, place.map_from_base, known);
    if (!known.empty()) surfaces_.emplace(known, kResolution_m, kDeviation_m, kLevels);
  }
  if (seen.empty() || !surfaces_) return {};
  const std::size_t stride = (seen.size() + kMostPoints - 1) / kMostPoints;
  std::vector<Eigen::Vector2f> some;
  for (std::size_t i = 0; i < seen.size(); i += stride) some.push_back(seen[i]);
  std::set<std::pair<int, int>> tiles;
  for (const Place& place : places_) {
    tiles.insert({static_cast<int>(std::floor(place.map_from_base.x_m / kTile_m)),
                  static_cast<int>(std::floor(place.map_from_base.y_m / kTile_m))});
  }

  const SearchWindow window{0.5 * kTile_m, M_PI, kAngleStep_rad};
  std::vector<CorrelativeMatch> found;
  double best = kLeastFit;
  for (const auto& [column, row] : tiles) {
    const Pose2 centre{(column + 0.5) * kTile_m, (row + 0.5) * kTile_m, 0.0};
    const auto match = searchPose(*surfaces_, some, centre, window, kNearBestFit * best);
    if (!match) continue;
    best = std::max(best, match->score);
    found.push_back(*match);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<Pose2> poses;
  for (const CorrelativeMatch& match : found) {
    if (match.score >= kNearBestFit * best && poses.size() < kMostCandidates)
      poses.push_back(match.map_from_laser);
  }
  return poses;
}

}  // namespace ram_slam
