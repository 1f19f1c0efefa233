// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/association.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ram_slam/fast_slam/associator.hpp"

namespace ram_slam {
namespace {

/// The landmarks of one path: independent of each other and of the pose.
class KnownPath {
public:
  KnownPath(const LandmarkTree& landmarks, const PoseWithCovariance2& map_from_base)
      : landmarks_(&landmarks), map_from_base_(map_from_base) {}

  const Eigen::Vector2d* find(LandmarkId id) const {
    const Landmark* landmark = landmarks_->find(id);
    return landmark == nullptr ? nullptr : &landmark->mean_m;
  }
  Innovation innovation(LandmarkId id, const PointMeasurement& measured) const {
    return ram_slam::innovation(map_from_base_, *landmarks_->find(id), measured);
  }
  void correct(const Innovation& found, LandmarkId, const PointMeasurement&) {
    map_from_base_ = corrected(map_from_base_, found);
  }
  const PoseWithCovariance2& pose() const { return map_from_base_; }

private:
  const LandmarkTree* landmarks_;
  PoseWithCovariance2 map_from_base_;
};

}  // namespace

bool Evidence::hasMatched(LandmarkId id) const {
  return std::any_of(
      associations.begin(), associations.end(), [id](const Association& association) {
        return association.outcome == AssociationOutcome::kMatched && association.id == id;
      });
}

void MatchQuality::add(const Evidence& evidence, double memory) {
  matched_count = new_count = ignored_count = 0;
  for (const Association& association : evidence.associations) {
    if (association.outcome == AssociationOutcome::kMatched) ++matched_count;
    if (association.outcome == AssociationOutcome::kNew) ++new_count;
    if (association.outcome == AssociationOutcome::kIgnored) ++ignored_count;
  }
  if (evidence.associations.empty()) return;
  const double matched = matched_count / static_cast<double>(evidence.associations.size());
  matched_fraction += (1.0 - memory) * (matched - matched_fraction);
  if (evidence.correction_count == 0) return;
  const double innovation = evidence.squared_mahalanobis / (2.0 * evidence.correction_count);
  normalised_innovation += (1.0 - memory) * (innovation - normalised_innovation);
}

Evidence associate(const std::vector<Observation>& observations,
                   const LandmarkTree& landmarks,
                   const PoseWithCovariance2& map_from_base,
                   const FastSlamParameters& parameters,
                   Random random) {
  Associator<KnownPath> associator(observations, {landmarks, map_from_base}, parameters);
  if (associator.passes()) associator.sample(random);
  return associator.finish();
}

Evidence associateCertain(const std::vector<Observation>& observations,
                          const LandmarkTree& landmarks,
                          const PoseWithCovariance2& map_from_base,
                          const FastSlamParameters& parameters) {
  Associator<KnownPath> associator(observations, {landmarks, map_from_base}, parameters);
  associator.passes();
  return associator.finish();
}

Evidence associateByDistance(const std::vector<Observation>& observations,
                             const LandmarkTree& landmarks,
                             const Pose2& map_from_base,
                             const FastSlamParameters& parameters) {
  Evidence evidence;
  evidence.map_from_base.pose = map_from_base;
  for (const Observation& observation : observations) {
    const Eigen::Vector2d place_m = map_from_base * observation.measured.position_m;
    const AssociationCandidate* nearest = nullptr;
    double distance_m = std::numeric_limits<double>::infinity();
    for (const AssociationCandidate& candidate : observation.candidates) {
      const Landmark* landmark = landmarks.find(candidate.id);
      if (landmark == nullptr || evidence.hasMatched(candidate.id)) continue;
      if ((landmark->mean_m - place_m).norm() >= distance_m) continue;
      distance_m = (landmark->mean_m - place_m).norm();
      nearest = &candidate;
    }
    Association association;
    if (distance_m < parameters.feature_match_distance) {
      association = {AssociationOutcome::kMatched, nearest->id};
      const Innovation found =
          innovation(map_from_base, *landmarks.find(nearest->id), observation.measured);
      evidence.log_likelihood_ratio +=
          found.logLikelihood() - std::log(parameters.unknown_feature_density);
      evidence.squared_mahalanobis += found.squaredMahalanobis();
      ++evidence.correction_count;
    } else if (distance_m >= parameters.minimum_feature_separation) {
      association.outcome = AssociationOutcome::kNew;
    }
    evidence.associations.push_back(association);
  }
  return evidence;
}

}  // namespace ram_slam
