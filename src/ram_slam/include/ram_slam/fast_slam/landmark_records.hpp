// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "ram_slam/fast_slam/landmark_registry.hpp"
#include "ram_slam/fast_slam/parameters.hpp"
#include "ram_slam/fast_slam/particle.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/feature_matcher.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"

namespace ram_slam {

/// \throws std::invalid_argument unless position and covariance are finite, and the covariance is
/// symmetric positive definite
void requireGood(const Feature& feature);
/// \throws std::invalid_argument unless the pose is finite, and its covariance symmetric positive
/// semi-definite
void requireGood(const PoseWithCovariance2& pose);
/// \param newest_ns  stamp of the last list
/// \throws std::invalid_argument if a feature is not good, or the list older than the last one
void requireGood(const FeatureList& list, std::int64_t newest_ns);

/// \throws std::invalid_argument if a pose of this stamp is older than the filter
void requireNotOlder(std::int64_t stamp_ns, std::int64_t filter_ns);

/// What is known of a stored landmark; its bounds are still empty. \throws std::invalid_argument if
/// position or covariance are not good
LandmarkRecord recordOf(const LandmarkEstimate& estimate,
                        const FeatureMatchers& matchers,
                        const FastSlamParameters& parameters);

/// The parsed classifier of each feature, null without one.
std::vector<DescriptorPointer> describe(const FeatureList& list, const FeatureMatchers& matchers);

/// A feature and its parsed classifier.
struct DescribedFeature {
  const Feature& feature;
  const DescriptorPointer& descriptor;
};

/// Remembers from where, and how, the landmark was seen from the particle's pose.
void rememberSighting(LandmarkRecord& record,
                      const Particle& particle,
                      const DescribedFeature& seen,
                      const FeatureMatchers& matchers,
                      const AppearanceParameters& parameters);

/// Where a landmark there can be matched. \param gate  squared Mahalanobis distance
Eigen::AlignedBox2d boundsOf(const Eigen::Vector2d& place_m,
                             const Eigen::Matrix2d& covariance_m2,
                             double gate);
/// Encloses where the landmark can be matched, in every particle.
/// \param gate  squared Mahalanobis distance
void refreshBounds(LandmarkRecord& record, const std::vector<Particle>& particles, double gate);

/// Landmarks that cannot be distinguished from an older one.
/// \param differenceCovariance  of the positions of a younger landmark and an older one [m^2]
std::vector<LandmarkId> duplicates(
    const LandmarkRegistry& registry,
    const LandmarkTree& landmarks,
    const std::function<Eigen::Matrix2d(LandmarkId, LandmarkId)>& differenceCovariance,
    const FeatureMatchers& matchers,
    const FastSlamParameters& parameters);

}  // namespace ram_slam
