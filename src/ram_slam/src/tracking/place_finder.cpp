// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/place_finder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {
namespace {

using Views = std::vector<LocalConstellation::PlacedView>;

/// At most so many of the views, spread over all of them, the newest included.
Views thinned(const Views& views, std::size_t most) {
  if (views.size() <= most) return views;
  Views some;
  for (std::size_t i = 1; i <= most; ++i) some.push_back(views[i * views.size() / most - 1]);
  return some;
}

struct JudgedPlace {
  PoseHypothesis hypothesis;
  ViewAgreement agreement;
};

class PlaceFinder {
public:
  PlaceFinder(const PlaceQuery& query,
              const FeatureMatchers& matchers,
              const ConstellationParameters& constellation,
              const PlaceFinderParameters& parameters)
      : map_(query.map),
        seen_(query.local.points()),
        all_views_(query.local.views()),
        views_(thinned(all_views_, static_cast<std::size_t>(parameters.max_views))),
        map_views_(query.map_views),
        expected_(query.expected),
        matchers_(matchers),
        constellation_(constellation),
        parameters_(parameters) {}

  std::optional<PoseWithCovariance2> find() const {
    if (static_cast<int>(seen_.size()) < minimumPairs()) return std::nullopt;
    const std::vector<JudgedPlace> places = withoutEqualsOfExpected(distinct(judged(proposals())));
    if (places.empty()) return std::nullopt;
    std::vector<PoseHypothesis> hypotheses;
    for (const JudgedPlace& place : places) hypotheses.push_back(place.hypothesis);
    ConstellationParameters demands = constellation_;
    demands.minimum_pairs = minimumPairs();
    if (!map_views_.empty()) demands.minimum_overlap = 0.0;
    const PoseHypothesis* best =
        uniqueHypothesis(hypotheses, seen_.size(), chanceScore(map_, constellation_), demands);
    if (best == nullptr) return std::nullopt;
    if (!map_views_.empty() && !agrees(places[best - hypotheses.data()].agreement))
      return std::nullopt;
    PoseWithCovariance2 place = best->target_from_source;
    const Eigen::Vector3d floor(parameters_.sigma_m, parameters_.sigma_m, parameters_.sigma_rad);
    place.covariance += Eigen::Matrix3d(floor.cwiseAbs2().asDiagonal());
    return place;
  }

private:
  int minimumPairs() const {
    return map_views_.empty()
               ? constellation_.minimum_pairs
               : std::min(constellation_.minimum_pairs, parameters_.pairs_with_views);
  }

  bool agrees(const ViewAgreement& agreement) const {
    return agreement.compared_count >= parameters_.min_compared &&
           2 * agreement.compared_count >= static_cast<int>(views_.size()) &&
           agreement.contradiction_ratio <= parameters_.max_contradiction_ratio;
  }

  std::vector<PoseHypothesis> proposals() const {
    std::vector<PoseHypothesis> all = matchConstellations(map_, seen_, matchers_, constellation_);
    for (const Pose2& pose : map_views_.candidates(all_views_))
      all.push_back(hypothesisAt(map_, seen_, matchers_, constellation_, pose));
    if (expected_) all.push_back(hypothesisAt(map_, seen_, matchers_, constellation_, *expected_));
    return all;
  }

  std::vector<JudgedPlace> judged(std::vector<PoseHypothesis> hypotheses) const {
    std::vector<JudgedPlace> places;
    for (PoseHypothesis& hypothesis : hypotheses) {
      const Pose2& pose = hypothesis.target_from_source.pose;
      std::vector<bool> paired(map_.size(), false);
      for (const ConstellationPair& pair : hypothesis.pairs) paired[pair.target] = true;
      const ViewAgreement agreement = map_views_.judge(views_, pose);
      hypothesis.score += missingLandmarksLogLikelihood(map_, paired, pose, views_, parameters_) +
                          agreement.evidence;
      places.push_back({std::move(hypothesis), agreement});
    }
    refineBest(places);
    return places;
  }

  /// The features leave poses some decimetres off, which the views take for a contradiction.
  void refineBest(std::vector<JudgedPlace>& places) const {
    std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
      return a.hypothesis.score > b.hypothesis.score;
    });
    const Views views = thinned(views_, static_cast<std::size_t>(parameters_.max_refining_views));
    int count = 0;
    for (JudgedPlace& place : places) {
      if (place.agreement.compared_count == 0 ||
          place.agreement.contradiction_ratio > parameters_.hopeless_ratio)
        continue;
      Pose2& pose = place.hypothesis.target_from_source.pose;
      pose = map_views_.refined(views, pose);
      const ViewAgreement better = map_views_.judge(views_, pose);
      place.hypothesis.score += better.evidence - place.agreement.evidence;
      place.agreement = better;
      if (++count == parameters_.max_refined) return;
    }
  }

  bool areOnePlace(const Pose2& a, const Pose2& b) const {
    return !MotionGate{constellation_.distinct_distance, constellation_.distinct_angle}.isReachedBy(
        a.inverse() * b);
  }

  /// The expected place alone if it agrees and none is better by what would make it unique.
  std::vector<JudgedPlace> withoutEqualsOfExpected(std::vector<JudgedPlace> places) const {
    if (!expected_ || places.empty()) return places;
    const double enough = places.front().hypothesis.score - constellation_.minimum_lead;
    const auto found = std::find_if(places.begin(), places.end(), [&](const JudgedPlace& place) {
      return areOnePlace(place.hypothesis.target_from_source.pose, *expected_);
    });
    if (found == places.end() || found->hypothesis.score < enough || !agrees(found->agreement))
      return places;
    return {std::move(*found)};
  }

  /// Best first, without those that are near a better one.
  std::vector<JudgedPlace> distinct(std::vector<JudgedPlace> places) const {
    std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
      return a.hypothesis.score > b.hypothesis.score;
    });
    std::vector<JudgedPlace> kept;
    for (JudgedPlace& place : places) {
      const Pose2& pose = place.hypothesis.target_from_source.pose;
      const bool known = std::any_of(kept.begin(), kept.end(), [&](const JudgedPlace& better) {
        return areOnePlace(better.hypothesis.target_from_source.pose, pose);
      });
      if (!known) kept.push_back(std::move(place));
    }
    return kept;
  }

  const Constellation& map_;
  Constellation seen_;
  Views all_views_;
  Views views_;
  const MapViews& map_views_;
  const std::optional<Pose2>& expected_;
  const FeatureMatchers& matchers_;
  const ConstellationParameters& constellation_;
  const PlaceFinderParameters& parameters_;
};

}  // namespace

const ram_parameters::ParameterTable<PlaceFinderParameters>& PlaceFinderParameters::table() {
  using P = PlaceFinderParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("pairs_with_views", &P::pairs_with_views, "", atLeast(2),
               "Pairs that are enough where the map has views, which have to agree then.")
          .add("min_compared", &P::min_compared, "", atLeast(1),
               "Views that must have been compared with the map's, besides half of all.")
          .add("max_contradiction_ratio", &P::max_contradiction_ratio, "", within(0.0, 1.0),
               "The most that views may contradict the map at an accepted place. The right place "
               "shows 0.00 to 0.03, others show 0.05 and more.")
          .add("hopeless_ratio", &P::hopeless_ratio, "", within(0.0, 1.0),
               "A place that views contradict in more than this share is not refined.")
          .add("sigma_m", &P::sigma_m, "m", positive(),
               "Standard deviation per axis added to that of an accepted place.")
          .add("sigma_rad", &P::sigma_rad, "rad", positive(), "The same of its yaw.")
          .add("max_views", &P::max_views, "", atLeast(1),
               "Views that are compared with the map: bounds what a search costs.")
          .add("max_refining_views", &P::max_refining_views, "", atLeast(1),
               "Views with which a place is refined.")
          .add("max_refined", &P::max_refined, "", atLeast(1), "Places that are refined.")
          .add("looked_through_evidence", &P::looked_through_evidence, "nat", within(-1e3, 0.0),
               "Of a landmark where most views show empty space.")
          .add("overlooked_evidence", &P::overlooked_evidence, "nat", within(-1e3, 0.0),
               "Of a landmark in view that pairs with nothing seen.")
          .add("min_sights", &P::min_sights, "", atLeast(1),
               "Views that must show the landmark's place for either.");
  return table;
}

double missingLandmarksLogLikelihood(const Constellation& map,
                                     const std::vector<bool>& paired,
                                     const Pose2& map_from_base,
                                     const std::vector<LocalConstellation::PlacedView>& views,
                                     const PlaceFinderParameters& parameters) {
  double sum = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    int empty_count = 0;
    int visible_count = 0;
    for (const LocalConstellation::PlacedView& placed : views) {
      const Pose2 then_from_map = (map_from_base * placed.base_from_then).inverse();
      const Sight sight = placed.view->look(then_from_map * map[i].position_m);
      if (sight == Sight::kEmpty) ++empty_count;
      if (sight == Sight::kVisible) ++visible_count;
    }
    if (empty_count > visible_count && empty_count >= parameters.min_sights) {
      sum += parameters.looked_through_evidence;
    } else if (!paired[i] && visible_count >= parameters.min_sights) {
      sum += parameters.overlooked_evidence;
    }
  }
  return sum;
}

std::optional<PoseWithCovariance2> findPlace(const PlaceQuery& query,
                                             const FeatureMatchers& matchers,
                                             const ConstellationParameters& constellation,
                                             const PlaceFinderParameters& parameters) {
  return PlaceFinder(query, matchers, constellation, parameters).find();
}

}  // namespace ram_slam
