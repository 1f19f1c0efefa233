// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/association_candidates.hpp"

#include <algorithm>
#include <cmath>

namespace ram_slam {

std::vector<Observation> AssociationCandidates::observe(
    const FeatureList& list, const std::vector<DescriptorPointer>& descriptors) const {
  const Eigen::Matrix2d floor_m2 = parameters_.feature_noise_floor *
                                   parameters_.feature_noise_floor * Eigen::Matrix2d::Identity();
  std::vector<Observation> observations(list.features.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Feature& feature = list.features[i];
    observations[i].type = feature.type;
    observations[i].measured = {feature.position_m, feature.covariance_m2 + floor_m2};
    const double noise_m = std::sqrt(observations[i].measured.covariance_m2.trace());
    const Eigen::AlignedBox2d area_m = searchArea(feature, noise_m);
    for (const LandmarkRecord& record : registry_.records()) {
      if (!area_m.intersects(record.bounds_m) || record.type != feature.type) continue;
      const double by_appearance = logLikelihoodRatio(findMatcher(matchers_, feature.type),
                                                      descriptors[i], record.descriptors);
      observations[i].candidates.push_back(
          {record.id, record.existence_log_odds >= parameters_.confirm_log_odds,
           by_appearance + orientationEvidence(record, feature)});
    }
  }
  return observations;
}

Eigen::AlignedBox2d AssociationCandidates::searchArea(const Feature& feature,
                                                      double noise_m) const {
  Eigen::AlignedBox2d area_m;
  double pose_variance_m2 = 0.0;
  for (const Particle& particle : particles_) {
    area_m.extend(particle.proposal.pose * feature.position_m);
    const Eigen::Matrix3d& c = particle.proposal.covariance;
    // Bounds the trace of H_x P H_x^T: the variance of position plus that of the lever arm,
    // doubled for their correlation.
    pose_variance_m2 = std::max(
        pose_variance_m2, 2.0 * (c(0, 0) + c(1, 1) + c(2, 2) * feature.position_m.squaredNorm()));
  }
  const double gate = std::sqrt(parameters_.creation_gate);
  const double reach_m =
      std::max({gate * (noise_m + std::sqrt(pose_variance_m2)),
                parameters_.minimum_feature_separation, parameters_.feature_match_distance});
  area_m.min().array() -= reach_m;
  area_m.max().array() += reach_m;
  return area_m;
}

double AssociationCandidates::orientationEvidence(const LandmarkRecord& record,
                                                  const Feature& feature) const {
  const AppearanceParameters& appearance = parameters_.appearance;
  const PoseWithCovariance2& map_from_base = particles_[best_].proposal;
  const double variance_rad2 = record.orientation_variance_rad2 +
                               feature.orientation_variance_rad2 + map_from_base.covariance(2, 2) +
                               appearance.orientation_sigma_rad * appearance.orientation_sigma_rad;
  return orientationLogRatio(
      map_from_base.pose.yaw_rad + feature.orientation_rad - record.orientation_rad, variance_rad2,
      appearance.wrong_orientation_share);
}

}  // namespace ram_slam
