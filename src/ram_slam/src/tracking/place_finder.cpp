// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/place_finder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ram_slam {
namespace {

// Where views agree: pairs that will do, views that must have been compared, and the most that they
// may contradict the map. The right place shows 0.00 to 0.03, others from 0.05 on.
constexpr int kPairsWithViews = 3;
constexpr int kLeastCompared = 3;
constexpr double kMostContradiction = 0.04;
// Beyond this a place is not worth a closer look.
constexpr double kHopeless = 0.3;
// Standard deviations of the place that is found: the filter finds the rest of the way.
constexpr double kFoundSigma_m = 0.05;
constexpr double kFoundSigma_rad = 0.02;

// What a search costs is bounded: views that are compared with the map, in all and where a place is
// refined, and places that are.
constexpr std::size_t kMostViews = 12;
constexpr std::size_t kMostRefiningViews = 6;
constexpr std::size_t kMostRefined = 4;

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
  PlaceFinder(const Constellation& map,
              const LocalConstellation& local,
              const MapViews& map_views,
              const std::optional<Pose2>& expected,
              const FeatureMatchers& matchers,
              const ConstellationParameters& parameters)
      : map_(map),
        seen_(local.points()),
        all_views_(local.views()),
        views_(thinned(all_views_, kMostViews)),
        map_views_(map_views),
        expected_(expected),
        matchers_(matchers),
        parameters_(parameters) {}

  std::optional<PoseWithCovariance2> find() const {
    if (static_cast<int>(seen_.size()) < minimumPairs()) return std::nullopt;
    const std::vector<JudgedPlace> places = withoutEqualsOfExpected(distinct(judged(proposals())));
    if (places.empty()) return std::nullopt;
    std::vector<PoseHypothesis> hypotheses;
    for (const JudgedPlace& place : places) hypotheses.push_back(place.hypothesis);
    ConstellationParameters parameters = parameters_;
    parameters.minimum_pairs = minimumPairs();
    if (!map_views_.empty()) parameters.minimum_overlap = 0.0;
    const PoseHypothesis* best =
        uniqueHypothesis(hypotheses, seen_.size(), chanceScore(map_, parameters_), parameters);
    if (best == nullptr) return std::nullopt;
    if (!map_views_.empty() && !agrees(places[best - hypotheses.data()].agreement))
      return std::nullopt;
    PoseWithCovariance2 place = best->target_from_source;
    const Eigen::Vector3d floor(kFoundSigma_m, kFoundSigma_m, kFoundSigma_rad);
    place.covariance += Eigen::Matrix3d(floor.cwiseAbs2().asDiagonal());
    return place;
  }

private:
  int minimumPairs() const {
    return map_views_.empty() ? parameters_.minimum_pairs
                              : std::min(parameters_.minimum_pairs, kPairsWithViews);
  }

  bool agrees(const ViewAgreement& agreement) const {
    return agreement.compared_count >= kLeastCompared &&
           2 * agreement.compared_count >= static_cast<int>(views_.size()) &&
           agreement.contradiction <= kMostContradiction;
  }

  std::vector<PoseHypothesis> proposals() const {
    std::vector<PoseHypothesis> all = matchConstellations(map_, seen_, matchers_, parameters_);
    for (const Pose2& pose : map_views_.candidates(all_views_))
      all.push_back(hypothesisAt(map_, seen_, matchers_, parameters_, pose));
    if (expected_) all.push_back(hypothesisAt(map_, seen_, matchers_, parameters_, *expected_));
    return all;
  }

  std::vector<JudgedPlace> judged(std::vector<PoseHypothesis> hypotheses) const {
    std::vector<JudgedPlace> places;
    for (PoseHypothesis& hypothesis : hypotheses) {
      const Pose2& pose = hypothesis.target_from_source.pose;
      std::vector<bool> paired(map_.size(), false);
      for (const ConstellationPair& pair : hypothesis.pairs) paired[pair.target] = true;
      const ViewAgreement agreement = map_views_.judge(views_, pose);
      hypothesis.score += contradiction(map_, paired, pose, views_) + agreement.evidence;
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
    const Views views = thinned(views_, kMostRefiningViews);
    std::size_t count = 0;
    for (JudgedPlace& place : places) {
      if (place.agreement.compared_count == 0 || place.agreement.contradiction > kHopeless)
        continue;
      Pose2& pose = place.hypothesis.target_from_source.pose;
      pose = map_views_.refined(views, pose);
      const ViewAgreement better = map_views_.judge(views_, pose);
      place.hypothesis.score += better.evidence - place.agreement.evidence;
      place.agreement = better;
      if (++count == kMostRefined) return;
    }
  }

  bool areOnePlace(const Pose2& a, const Pose2& b) const {
    const Pose2 away = a.inverse() * b;
    return away.translation().norm() < parameters_.distinct_distance &&
           std::abs(away.yaw_rad) < parameters_.distinct_angle;
  }

  /// The expected place alone if it agrees and none is better by what would make it unique.
  std::vector<JudgedPlace> withoutEqualsOfExpected(std::vector<JudgedPlace> places) const {
    if (!expected_ || places.empty()) return places;
    const double enough = places.front().hypothesis.score - parameters_.minimum_lead;
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
  const ConstellationParameters& parameters_;
};

}  // namespace

std::optional<PoseWithCovariance2> findPlace(const Constellation& map,
                                             const LocalConstellation& local,
                                             const MapViews& map_views,
                                             const std::optional<Pose2>& expected,
                                             const FeatureMatchers& matchers,
                                             const ConstellationParameters& parameters) {
  return PlaceFinder(map, local, map_views, expected, matchers, parameters).find();
}

}  // namespace ram_slam
