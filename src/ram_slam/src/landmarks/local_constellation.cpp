// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/landmarks/local_constellation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "ram_slam/geometry/motion_gate.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<LocalConstellationParameters>&
LocalConstellationParameters::table() {
  using P = LocalConstellationParameters;
  using namespace ram_parameters;
  static const auto table =
      ParameterTable<P>()
          .add("length", &P::length, "m", positive(),
               "While lost, the features of so much driving are put together, ...")
          .add("minimum_sightings", &P::minimum_sightings, "", atLeast(1),
               "... of those that were seen so often; others are taken for errors of the detector.")
          .add("drift_per_m", &P::drift_per_m, "m/m", atLeast(0.0),
               "Standard deviation that odometry adds to a feature's position per metre driven "
               "since it was seen.")
          .expert("The features of a lost robot")
          .add("point_match_distance", &P::match_distance, "m", positive(),
               "A feature nearer than this to a known point of its type is that point.")
          .add("max_points", &P::max_points, "", atLeast(2), "The newest are kept.")
          .add("max_descriptors", &P::max_descriptors, "", atLeast(0), "Kept per point.")
          .add("turn_as_path_m", &P::turn_as_path_m, "m/rad", atLeast(0.0),
               "A radian of turning ages a point as much as this way.")
          .add("view_spacing_m", &P::view_spacing_m, "m", atLeast(0.0),
               "A view is kept after so much driving ...")
          .add("view_spacing_rad", &P::view_spacing_rad, "rad", atLeast(0.0), "... or turning.")
          .add("min_sigma_m", &P::min_sigma_m, "m", atLeast(0.0),
               "Added to the stated standard deviation of a feature per axis.")
          .add("new_descriptor_below", &P::new_descriptor_below, "nat", anyNumber(),
               "A descriptor less alike than this to those of the point is kept, too.");
  return table;
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
  distance_m_ += before_from_now.translation().norm() +
                 parameters_.turn_as_path_m * std::abs(before_from_now.yaw_rad);
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
  const auto max_points = static_cast<std::size_t>(parameters_.max_points);
  if (points_.size() > max_points) {
    std::stable_sort(points_.begin(), points_.end(),
                     [](const Point& a, const Point& b) { return a.seen_at_m > b.seen_at_m; });
    points_.resize(max_points);
  }
  while (!views_.empty() && views_.front().seen_at_m < oldest_m) views_.pop_front();
}

void LocalConstellation::addFeature(const Feature& feature, std::vector<bool>& used) {
  const Eigen::Matrix2d turn = local_from_base_.rotation();
  ConstellationPoint seen;
  seen.type = feature.type;
  seen.position_m = local_from_base_ * feature.position_m;
  seen.covariance_m2 =
      turn * feature.covariance_m2 * turn.transpose() +
      parameters_.min_sigma_m * parameters_.min_sigma_m * Eigen::Matrix2d::Identity();
  seen.orientation_rad = wrapAngle(local_from_base_.yaw_rad + feature.orientation_rad);
  seen.orientation_variance_rad2 = feature.orientation_variance_rad2;
  const auto matcher = matchers_.find(feature.type);
  const DescriptorPointer descriptor = matcher == matchers_.end() || feature.classifier.empty()
                                           ? nullptr
                                           : matcher->second->parse(feature.classifier);
  const std::optional<std::size_t> known = nearest(feature.type, seen.position_m, used);
  if (!known) {
    if (descriptor != nullptr) seen.descriptors.push_back(descriptor);
    points_.push_back({std::move(seen), 1, distance_m_});
    used.push_back(true);
    return;
  }
  used[*known] = true;
  Point& point = points_[*known];
  update(point, seen);
  point.seen_at_m = distance_m_;
  ++point.sightings;
  if (descriptor != nullptr) addDescriptor(point, descriptor);
}

std::optional<std::size_t> LocalConstellation::nearest(const std::string& type,
                                                       const Eigen::Vector2d& place_m,
                                                       const std::vector<bool>& used) const {
  std::optional<std::size_t> nearest;
  double distance_m = parameters_.match_distance;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double away_m = (points_[i].place.position_m - place_m).norm();
    if (used[i] || points_[i].place.type != type || away_m >= distance_m) continue;
    nearest = i;
    distance_m = away_m;
  }
  return nearest;
}

void LocalConstellation::update(Point& point, const ConstellationPoint& seen) const {
  const double aged_m = parameters_.drift_per_m * (distance_m_ - point.seen_at_m);
  const Eigen::Matrix2d before_m2 =
      point.place.covariance_m2 + aged_m * aged_m * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d gain = before_m2 * (before_m2 + seen.covariance_m2).inverse();
  point.place.position_m += gain * (seen.position_m - point.place.position_m);
  const Eigen::Matrix2d after_m2 = (Eigen::Matrix2d::Identity() - gain) * before_m2;
  point.place.covariance_m2 = 0.5 * (after_m2 + after_m2.transpose());
  if (seen.orientation_variance_rad2 < point.place.orientation_variance_rad2) {
    point.place.orientation_rad = seen.orientation_rad;
    point.place.orientation_variance_rad2 = seen.orientation_variance_rad2;
  }
}

void LocalConstellation::addDescriptor(Point& point, const DescriptorPointer& descriptor) const {
  std::vector<DescriptorPointer>& known = point.place.descriptors;
  if (static_cast<int>(known.size()) < parameters_.max_descriptors &&
      logLikelihoodRatio(matchers_.at(point.place.type).get(), descriptor, known) <=
          parameters_.new_descriptor_below) {
    known.push_back(descriptor);
  }
}

void LocalConstellation::addView(std::shared_ptr<const FieldOfView> view) {
  if (!views_.empty()) {
    const Pose2 since = views_.back().local_from_base.inverse() * local_from_base_;
    if (!MotionGate{parameters_.view_spacing_m, parameters_.view_spacing_rad}.isReachedBy(since))
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

}  // namespace ram_slam
