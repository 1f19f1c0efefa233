// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/constellation_memory.hpp"

#include <utility>

namespace ram_slam {
namespace {

ConstellationParameters parametersOfSearch() {
  ConstellationParameters parameters;
  parameters.minimum_likeness = 0.0;  // unlike pairs would only take time
  // A part of the stretch may lie on new ground, and the scans verify the place.
  parameters.minimum_overlap = 0.0;
  return parameters;
}

}  // namespace

ConstellationMemory::ConstellationMemory(const FeatureMatchers& matchers, double stretch_m)
    : matchers_(matchers), stretch_m_(stretch_m), recent_({stretch_m}, matchers) {}

void ConstellationMemory::add(const FeatureList& list,
                              const std::vector<KeyScan>& keys,
                              const Pose2& odom_from_base) {
  const Pose2 motion = odom_from_base_ ? odom_from_base_->inverse() * odom_from_base : Pose2{};
  odom_from_base_ = odom_from_base;
  recent_.add(list, motion, nullptr);
  if (keys.back().path_m - remembered_path_m_ < stretch_m_) return;
  remembered_path_m_ = keys.back().path_m;
  stretches_.push_back({keys.size() - 1, recent_.points()});
}

std::optional<Pose2> ConstellationMemory::findPlace(const std::vector<KeyScan>& keys,
                                                    double min_path_m) const {
  Constellation map;
  for (const Stretch& stretch : stretches_) {
    if (keys[stretch.key].path_m > keys.back().path_m - min_path_m) break;
    const Pose2 map_from_base = keys[stretch.key].map_from_base();
    const Eigen::Matrix2d rotation = map_from_base.rotation();
    for (ConstellationPoint point : stretch.points) {
      point.position_m = map_from_base * point.position_m;
      point.covariance_m2 = rotation * point.covariance_m2 * rotation.transpose();
      point.orientation_rad = wrapAngle(map_from_base.yaw_rad + point.orientation_rad);
      map.push_back(std::move(point));
    }
  }
  if (map.empty()) return std::nullopt;
  const ConstellationParameters parameters = parametersOfSearch();
  const Constellation seen = recent_.points();
  const std::vector<PoseHypothesis> hypotheses =
      matchConstellations(map, seen, matchers_, parameters);
  const PoseHypothesis* best =
      uniqueHypothesis(hypotheses, seen.size(), chanceScore(map, parameters), parameters);
  if (best == nullptr) return std::nullopt;
  return best->target_from_source.pose;
}

}  // namespace ram_slam
