// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/tracking/local_constellation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "ram_parameters/require.hpp"

namespace ram_slam {
namespace {

constexpr std::size_t kMostPoints = 60;  // the newest are kept
constexpr std::size_t kMostLooks = 4;    // kept per point
constexpr double kTurnIsWay_m = 0.3;     // a radian of turning ages a point as much as this way
constexpr double kViewEvery_m = 0.5;
constexpr double kViewEvery_rad = 0.7;
constexpr double kLeastSigma_m = 0.02;
constexpr double kOddLooks = 0.0;  // [nat] a look less alike than this to those known is new
// Evidence of one landmark in all views together [nat]; views of one place are not independent.
constexpr double kLookedThrough = -2.0;
constexpr double kOverlooked = -0.5;
constexpr int kLeastLooks = 2;

using ram_parameters::require;

}  // namespace

void LocalConstellationParameters::validate() const {
  require(length > 0.0, "length", length, "> 0");
  require(match_distance > 0.0, "match_distance", match_distance, "> 0");
  require(minimum_sightings >= 1, "minimum_sightings", minimum_sightings, ">= 1");
  require(drift_per_m >= 0.0, "drift_per_m", drift_per_m, ">= 0");
}

LocalConstellation::LocalConstellation(const LocalConstellationParameters& parameters,
                                       FeatureMatchers matchers)
    : parameters_(parameters), matchers_(std::move(matchers)) {
  parameters_.validate();
}

void LocalConstellation::clear() {
  local_from_base_ = {};
  distance_m_ = 0.0;
  points_.clear();
  views_.clear();
}

void LocalConstellation::add(const FeatureList& list,
                             const Pose2& before_from_now,
                             std::shared_ptr<const FieldOfView> view) {
  local_from_base_ = local_from_base_ * before_from_now;
  distance_m_ +=
      before_from_now.translation().norm() + kTurnIsWay_m * std::abs(before_from_now.yaw_rad);
  forget();
  std::vector<bool> used(points_.size(), false);
  for (const Feature& feature : list.features) addFeature(feature, used);
  if (view != nullptr) addView(std::move(view));
}

void LocalConstellation::forget() {
  const double oldest_m = distance_m_ - parameters_.length;
  points_.erase(std::remove_if(points_.begin(), points_.end(),
                               [&](const Point& point) { return point.seen_at_m < oldest_m; }),
                points_.end());
  if (points_.size() > kMostPoints) {
    std::stable_sort(points_.begin(), points_.end(),
                     [](const Point& a, const Point& b) { return a.seen_at_m > b.seen_at_m; });
    points_.resize(kMostPoints);
  }
  while (!views_.empty() && views_.front().seen_at_m < oldest_m) views_.pop_front();
}

void LocalConstellation::addFeature(const Feature& feature, std::vector<bool>& used) {
  const Eigen::Vector2d place_m = local_from_base_ * feature.position_m;
  const Eigen::Matrix2d turn = local_from_base_.rotation();
  const Eigen::Matrix2d noise_m2 = turn * feature.covariance_m2 * turn.transpose() +
                                   kLeastSigma_m * kLeastSigma_m * Eigen::Matrix2d::Identity();
  const double orientation_rad = wrapAngle(local_from_base_.yaw_rad + feature.orientation_rad);
  const auto matcher = matchers_.find(feature.type);
  const DescriptorPointer looks = matcher == matchers_.end() || feature.classifier.empty()
                                      ? nullptr
                                      : matcher->second->parse(feature.classifier);
  std::size_t nearest = used.size();
  double distance_m = parameters_.match_distance;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double away_m = (points_[i].place.position_m - place_m).norm();
    if (used[i] || points_[i].place.type != feature.type || away_m >= distance_m) continue;
    nearest = i;
    distance_m = away_m;
  }
  if (nearest == used.size()) {
    Point point;
    point.place = {feature.type, place_m,         noise_m2,
                   {},           orientation_rad, feature.orientation_variance_rad2};
    if (looks != nullptr) point.place.views.push_back(looks);
    point.sightings = 1;
    point.seen_at_m = distance_m_;
    points_.push_back(point);
    used.push_back(true);
    return;
  }
  used[nearest] = true;
  Point& point = points_[nearest];
  const double aged_m = parameters_.drift_per_m * (distance_m_ - point.seen_at_m);
  const Eigen::Matrix2d before_m2 =
      point.place.covariance_m2 + aged_m * aged_m * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d gain = before_m2 * (before_m2 + noise_m2).inverse();
  point.place.position_m += gain * (place_m - point.place.position_m);
  const Eigen::Matrix2d after_m2 = (Eigen::Matrix2d::Identity() - gain) * before_m2;
  point.place.covariance_m2 = 0.5 * (after_m2 + after_m2.transpose());
  if (feature.orientation_variance_rad2 < point.place.orientation_variance_rad2) {
    point.place.orientation_rad = orientation_rad;
    point.place.orientation_variance_rad2 = feature.orientation_variance_rad2;
  }
  point.seen_at_m = distance_m_;
  ++point.sightings;
  if (looks != nullptr && point.place.views.size() < kMostLooks &&
      logLikelihoodRatio(matcher->second.get(), looks, point.place.views) <= kOddLooks) {
    point.place.views.push_back(looks);
  }
}

void LocalConstellation::addView(std::shared_ptr<const FieldOfView> view) {
  if (!views_.empty()) {
    const Pose2 since = views_.back().local_from_base.inverse() * local_from_base_;
    if (since.translation().norm() < kViewEvery_m && std::abs(since.yaw_rad) < kViewEvery_rad)
      return;
  }
  views_.push_back({local_from_base_, distance_m_, std::move(view)});
}

Constellation LocalConstellation::points() const {
  const Pose2 base_from_local = local_from_base_.inverse();
  const Eigen::Matrix2d turn = base_from_local.rotation();
  Constellation seen;
  for (const Point& point : points_) {
    if (point.sightings < parameters_.minimum_sightings) continue;
    const double drift_m = parameters_.drift_per_m * (distance_m_ - point.seen_at_m);
    seen.push_back(point.place);
    seen.back().position_m = base_from_local * point.place.position_m;
    seen.back().orientation_rad = wrapAngle(base_from_local.yaw_rad + point.place.orientation_rad);
    seen.back().covariance_m2 = turn * point.place.covariance_m2 * turn.transpose() +
                                drift_m * drift_m * Eigen::Matrix2d::Identity();
  }
  return seen;
}

std::vector<LocalConstellation::PlacedView> LocalConstellation::views() const {
  const Pose2 base_from_local = local_from_base_.inverse();
  std::vector<PlacedView> placed;
  for (const View& view : views_)
    placed.push_back({base_from_local * view.local_from_base, view.view});
  return placed;
}

double contradiction(const Constellation& map,
                     const std::vector<bool>& paired,
                     const Pose2& map_from_base,
                     const std::vector<LocalConstellation::PlacedView>& views) {
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
    if (empty_count > visible_count && empty_count >= kLeastLooks) {
      sum += kLookedThrough;
    } else if (!paired[i] && visible_count >= kLeastLooks) {
      sum += kOverlooked;
    }
  }
  return sum;
}

}  // namespace ram_slam
