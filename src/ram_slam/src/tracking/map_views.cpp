// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/map_views.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace ram_slam {
namespace {

void appendSurfaces(const FieldOfView& view,
                    const Pose2& target_from_base,
                    std::vector<Eigen::Vector2f>& points) {
  const Eigen::Matrix2d rotation = target_from_base.rotation();
  for (const Eigen::Vector2d& point_m : view.surface_m())
    points.push_back((target_from_base.translation() + rotation * point_m).cast<float>());
}

/// At most so many of the points, spread evenly.
std::vector<Eigen::Vector2f> everyNth(const std::vector<Eigen::Vector2f>& points,
                                      std::size_t max_count) {
  const std::size_t stride = (points.size() + max_count - 1) / max_count;
  std::vector<Eigen::Vector2f> some;
  for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
  return some;
}

}  // namespace

const ram_parameters::ParameterTable<MapViewsParameters::Refinement>&
MapViewsParameters::Refinement::table() {
  using P = MapViewsParameters::Refinement;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("step_m", &P::step_m, "m", positive(), "First step of the search around a pose.")
          .add("step_rad", &P::step_rad, "rad", positive(), "First step of the yaw.")
          .add("halvings", &P::halvings, "", atLeast(1), "How often the steps are halved.");
  return table;
}

const ram_parameters::ParameterTable<MapViewsParameters::Search>&
MapViewsParameters::Search::table() {
  using P = MapViewsParameters::Search;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("tile_m", &P::tile_m, "m", positive(),
               "Side of the squares of which each gives one candidate at most.")
          .add("resolution_m", &P::resolution_m, "m", positive(), "Of the likelihood grid.")
          .add("deviation_m", &P::deviation_m, "m", positive(),
               "Standard deviation of the surfaces in the likelihood grid.")
          .add("levels", &P::levels, "", atLeast(1), "Grids of the search, each half as fine.")
          .add("angle_step_rad", &P::angle_step_rad, "rad", positive(), "Step of the yaw.")
          .add("min_fit", &P::min_fit, "", within(0.0, 1.0), "Least fit of a candidate.")
          .add("near_best_fit", &P::near_best_fit, "", within(0.0, 1.0),
               "A candidate with less than this share of the best one's fit is dropped.")
          .add("max_candidates", &P::max_candidates, "", atLeast(1), "That are returned.")
          .add("max_views", &P::max_views, "", atLeast(1),
               "The newest views of the way driven, which are searched for.")
          .add("max_points", &P::max_points, "", atLeast(1), "Of all these views.");
  return table;
}

const ram_parameters::ParameterTable<MapViewsParameters>& MapViewsParameters::table() {
  using P = MapViewsParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("same_place_m", &P::same_place_m, "m", positive(),
               "Views nearer to each other than this ...")
          .add("same_place_rad", &P::same_place_rad, "rad", positive(),
               "... and turned by less than this are of one place; one per place is kept.")
          .add("max_distance_m", &P::max_distance_m, "m", positive(),
               "Of places that a view is compared with.")
          .add("max_compared", &P::max_compared, "", atLeast(1),
               "Places that a view is compared with, the nearest first.")
          .add("neutral_ratio", &P::neutral_ratio, "", aboveUpTo(0.0, 1.0),
               "Share of contradiction that is no evidence: views of one place show less, of two "
               "places more.")
          .add("max_evidence", &P::max_evidence, "nat", atLeast(0.0),
               "The most that one view may count for a pose.")
          .add("max_counterevidence", &P::max_counterevidence, "nat", atLeast(0.0),
               "The most that one view may count against a pose.")
          .add("trusted_path_m", &P::trusted_path_m, "m", positive(),
               "A view of the map is compared with a tracked robot's for so much driving after it "
               "last agreed.")
          .section("refinement", &P::refinement, Refinement::table())
          .section("search", &P::search, Search::table());
  return table;
}

void MapViews::add(std::int64_t stamp_ns,
                   const Pose2& map_from_base,
                   double path_m,
                   std::shared_ptr<const FieldOfView> view) {
  if (view == nullptr || knowsPlace(map_from_base)) return;
  places_.push_back({stamp_ns, map_from_base, std::move(view), path_m});
  surfaces_.reset();
}

void MapViews::addLoaded(const PlacedView& placed) {
  if (placed.view == nullptr || knowsPlace(placed.map_from_base)) return;
  places_.push_back({0, placed.map_from_base, placed.view, 0.0, true});
  surfaces_.reset();
}

bool MapViews::knowsPlace(const Pose2& map_from_base) const {
  return std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
    const Eigen::Vector2d away_m = place.map_from_base.translation() - map_from_base.translation();
    return away_m.squaredNorm() < parameters_.same_place_m * parameters_.same_place_m &&
           std::abs(wrapAngle(map_from_base.yaw_rad - place.map_from_base.yaw_rad)) <
               parameters_.same_place_rad;
  });
}

void MapViews::clear() {
  places_.clear();
  surfaces_.reset();
}

void MapViews::follow(const Trajectory& path) {
  surfaces_.reset();
  std::vector<Place> kept;
  for (Place& place : places_) {
    if (!place.is_loaded) {
      const std::optional<Pose2> pose = poseAt(path, place.stamp_ns);
      if (!pose) continue;
      place.map_from_base = *pose;
    }
    kept.push_back(std::move(place));
  }
  places_ = std::move(kept);
}

std::vector<std::size_t> MapViews::near(const Pose2& map_from_base) const {
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const double away_m2 =
        (places_[i].map_from_base.translation() - map_from_base.translation()).squaredNorm();
    if (away_m2 < parameters_.max_distance_m * parameters_.max_distance_m)
      by_distance.push_back({away_m2, i});
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<std::size_t> indices;
  for (const auto& [away_m2, index] : by_distance) indices.push_back(index);
  return indices;
}

std::optional<double> MapViews::contradictionRatio(const FieldOfView& view,
                                                   const Pose2& map_from_base) const {
  double sum = 0.0;
  int count = 0;
  for (const std::size_t i : near(map_from_base)) {
    const auto ratio =
        discontinuity(*places_[i].view, view, places_[i].map_from_base.inverse() * map_from_base);
    if (!ratio) continue;
    sum += *ratio;
    if (++count == parameters_.max_compared) break;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

std::optional<double> MapViews::trackedContradictionRatio(const FieldOfView& view,
                                                          const Pose2& map_from_base,
                                                          double path_m) {
  double sum = 0.0;
  int trusted_count = 0;
  int count = 0;
  for (const std::size_t i : near(map_from_base)) {
    const auto ratio =
        discontinuity(*places_[i].view, view, places_[i].map_from_base.inverse() * map_from_base);
    if (!ratio) continue;
    if (path_m - places_[i].agreed_at_m < parameters_.trusted_path_m) {
      sum += *ratio;
      ++trusted_count;
    }
    if (*ratio < parameters_.neutral_ratio) places_[i].agreed_at_m = path_m;
    if (++count == parameters_.max_compared) break;
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
    const auto ratio = contradictionRatio(*placed.view, map_from_base * placed.base_from_then);
    if (!ratio) continue;
    ++agreement.compared_count;
    agreement.contradiction_ratio += *ratio;
    agreement.evidence +=
        std::max(parameters_.max_evidence * (1.0 - *ratio / parameters_.neutral_ratio),
                 -parameters_.max_counterevidence);
  }
  if (agreement.compared_count > 0) agreement.contradiction_ratio /= agreement.compared_count;
  return agreement;
}

Pose2 MapViews::refined(const std::vector<LocalConstellation::PlacedView>& views,
                        const Pose2& map_from_base) const {
  Pose2 best = map_from_base;
  ViewAgreement least = judge(views, best);
  double step_m = parameters_.refinement.step_m;
  double step_rad = parameters_.refinement.step_rad;
  for (int halving = 0; halving < parameters_.refinement.halvings;) {
    const Pose2 centre = best;
    bool better = false;
    for (const Pose2& step :
         {Pose2{step_m, 0.0, 0.0}, Pose2{-step_m, 0.0, 0.0}, Pose2{0.0, step_m, 0.0},
          Pose2{0.0, -step_m, 0.0}, Pose2{0.0, 0.0, step_rad}, Pose2{0.0, 0.0, -step_rad}}) {
      const ViewAgreement agreement = judge(views, centre * step);
      if (agreement.compared_count < least.compared_count ||
          agreement.contradiction_ratio >= least.contradiction_ratio)
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

const LikelihoodPyramid* MapViews::surfaces() const {
  if (!surfaces_) {
    const MapViewsParameters::Search& search = parameters_.search;
    std::vector<Eigen::Vector2f> known;
    for (const Place& place : places_) appendSurfaces(*place.view, place.map_from_base, known);
    if (!known.empty())
      surfaces_.emplace(known, search.resolution_m, search.deviation_m, search.levels);
  }
  return surfaces_ ? &*surfaces_ : nullptr;
}

std::vector<Pose2> MapViews::candidates(
    const std::vector<LocalConstellation::PlacedView>& views) const {
  const MapViewsParameters::Search& search = parameters_.search;
  const std::size_t view_count = std::min(views.size(), static_cast<std::size_t>(search.max_views));
  std::vector<Eigen::Vector2f> seen;
  for (std::size_t i = views.size() - view_count; i < views.size(); ++i)
    appendSurfaces(*views[i].view, views[i].base_from_then, seen);
  const LikelihoodPyramid* known = surfaces();
  if (seen.empty() || known == nullptr) return {};
  seen = everyNth(seen, static_cast<std::size_t>(search.max_points));
  std::set<std::pair<int, int>> tiles;
  for (const Place& place : places_) {
    tiles.insert({static_cast<int>(std::floor(place.map_from_base.x_m / search.tile_m)),
                  static_cast<int>(std::floor(place.map_from_base.y_m / search.tile_m))});
  }

  const SearchWindow window{0.5 * search.tile_m, M_PI, search.angle_step_rad};
  std::vector<CorrelativeMatch> found;
  double best = search.min_fit;
  for (const auto& [column, row] : tiles) {
    const Pose2 centre{(column + 0.5) * search.tile_m, (row + 0.5) * search.tile_m, 0.0};
    const auto match = searchPose(*known, seen, centre, window, search.near_best_fit * best);
    if (!match) continue;
    best = std::max(best, match->score);
    found.push_back(*match);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<Pose2> poses;
  for (const CorrelativeMatch& match : found) {
    if (match.score >= search.near_best_fit * best &&
        static_cast<int>(poses.size()) < search.max_candidates)
      poses.push_back(match.map_from_laser);
  }
  return poses;
}

}  // namespace ram_slam
