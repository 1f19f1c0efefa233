// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>

#include "ram_slam/fast_slam/fast_slam.hpp"
#include "ram_slam/fast_slam/landmark_records.hpp"
#include "ram_slam/fast_slam/pose_estimate.hpp"
#include "ram_slam/fast_slam/resampling.hpp"

namespace ram_slam {

void FastSlam::updateMaps(const FeatureList& list,
                          const std::vector<DescriptorPointer>& descriptors,
                          const std::vector<Observation>& observations,
                          const std::vector<Evidence>& evidence) {
  const std::vector<double> weights = weightsOf(particles_);
  std::vector<std::optional<LandmarkId>> fresh_ids(observations.size());
  std::map<LandmarkId, double> matched_weights;  // of the landmarks that some particle changed
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    Particle& particle = particles_[k];
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const Association& association = evidence[k].associations[i];
      const PointMeasurement& measured = observations[i].measured;
      if (association.outcome == AssociationOutcome::kMatched) {
        const Landmark& before = *particle.landmarks.find(association.id);
        const Innovation found = innovation(particle.map_from_base, before, measured);
        particle.landmarks.set(association.id, updated(before, found, measured));
        matched_weights[association.id] += weights[k];
      } else if (association.outcome == AssociationOutcome::kNew) {
        std::optional<LandmarkId> id = idUsedElsewhere(observations[i], particle);
        if (!id && !fresh_ids[i]) {
          LandmarkRecord& record = registry_.create(list.features[i], descriptors[i]);
          record.placed_ns = stamp_ns_;
          record.seen_within_m = list.features[i].position_m.norm();
          record.drift = drift_.covariance();
          fresh_ids[i] = record.id;
        }
        if (!id) id = fresh_ids[i];
        particle.landmarks.set(*id, createLandmark(particle.map_from_base, measured));
        matched_weights[*id] += 0.0;
      }
    }
  }
  for (const auto& [id, weight] : matched_weights) {
    LandmarkRecord& record = *registry_.find(id);
    record.matched_weight = weight;
    refreshBounds(record, particles_, parameters_.creation_gate);
  }
  const std::vector<Association>& seen = evidence[best_].associations;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].outcome == AssociationOutcome::kMatched)
      rememberSighting(*registry_.find(seen[i].id), particles_[best_],
                       {list.features[i], descriptors[i]}, matchers_, parameters_.appearance);
  }
}

std::optional<LandmarkId> FastSlam::idUsedElsewhere(const Observation& observation,
                                                    const Particle& particle) const {
  const Eigen::Vector2d place_m = particle.map_from_base * observation.measured.position_m;
  std::optional<LandmarkId> nearest;
  double least_m = parameters_.minimum_feature_separation;
  for (const AssociationCandidate& candidate : observation.candidates) {
    if (particle.landmarks.find(candidate.id) != nullptr) continue;
    const LandmarkRecord& record = *registry_.find(candidate.id);
    const double distance_m = (record.bounds_m.center() - place_m).norm();
    if (distance_m >= least_m) continue;
    least_m = distance_m;
    nearest = candidate.id;
  }
  return nearest;
}

void FastSlam::resample() {
  const std::vector<double> weights = weightsOf(particles_);
  if (!proposal_->isResamplingDue(effectiveCount(weights), weights.size())) return;
  Random random(parameters_.seed, update_count_, particles_.size());
  const std::vector<std::size_t> kept = resampleLowVariance(weights, random);
  std::vector<Particle> particles;
  particles.reserve(particles_.size());
  for (const std::size_t i : kept) particles.push_back(particles_[i]);
  best_ =
      static_cast<std::size_t>(std::lower_bound(kept.begin(), kept.end(), best_) - kept.begin());
  particles_ = std::move(particles);
  for (Particle& particle : particles_) particle.log_weight = 0.0;
  forgetAbandoned();
}

}  // namespace ram_slam
