// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/fast_slam/association.hpp"
#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/landmarks/feature.hpp"

namespace ram_slam {

/// Finds the landmarks that features may show, once for all particles.
class AssociationCandidates {
public:
  /// All outlive this. \param best  index of the particle whose pose turns orientations into the
  /// map
  AssociationCandidates(const FastSlamParameters& parameters,
                        const FeatureMatchers& matchers,
                        const LandmarkRegistry& registry,
                        const std::vector<Particle>& particles,
                        std::size_t best)
      : parameters_(parameters),
        matchers_(matchers),
        registry_(registry),
        particles_(particles),
        best_(best) {}

  /// One observation per feature. \param descriptors  one per feature, null without one
  std::vector<Observation> observe(const FeatureList& list,
                                   const std::vector<DescriptorPointer>& descriptors) const;

private:
  /// Where particles place a feature, widened by how far off the landmark may be.
  Eigen::AlignedBox2d searchArea(const Feature& feature, double noise_m) const;
  /// Log-likelihood ratio of a feature's orientation.
  double orientationEvidence(const LandmarkRecord& record, const Feature& feature) const;

  const FastSlamParameters& parameters_;
  const FeatureMatchers& matchers_;
  const LandmarkRegistry& registry_;
  const std::vector<Particle>& particles_;
  std::size_t best_;
};

}  // namespace ram_slam
