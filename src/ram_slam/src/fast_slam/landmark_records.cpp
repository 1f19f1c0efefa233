// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_records.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace ram_slam {
namespace {

constexpr double kSymmetryTolerance = 1e-9;  // rounding of covariances, relative to their size

}  // namespace

void requireGood(const Feature& feature) {
  const Eigen::Matrix2d& c = feature.covariance_m2;
  const bool finite = feature.position_m.allFinite() && c.allFinite();
  if (!finite || std::abs(c(0, 1) - c(1, 0)) > kSymmetryTolerance * c.trace() || !(c(0, 0) > 0.0) ||
      !(c.determinant() > 0.0)) {
    throw std::invalid_argument(
        "a feature's position and covariance must be finite, the covariance symmetric and positive "
        "definite");
  }
}

void requireGood(const PoseWithCovariance2& pose) {
  const Eigen::Matrix3d& c = pose.covariance;
  if (!pose.pose.isFinite() || !c.allFinite()) {
    throw std::invalid_argument("an initial pose and its covariance must be finite");
  }
  const double tolerance = kSymmetryTolerance * (1.0 + c.norm());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(c, Eigen::EigenvaluesOnly);
  if ((c - c.transpose()).norm() > tolerance || solver.eigenvalues().minCoeff() < -tolerance) {
    throw std::invalid_argument(
        "the covariance of an initial pose must be symmetric positive semi-definite");
  }
}

void requireGood(const FeatureList& list, std::int64_t newest_ns) {
  for (const Feature& feature : list.features) requireGood(feature);
  if (list.stamp_ns <= 0 || list.stamp_ns < newest_ns) {
    throw std::invalid_argument("features of " + std::to_string(list.stamp_ns) +
                                " ns are older than those before, of " + std::to_string(newest_ns) +
                                " ns");
  }
}

void requireNotOlder(std::int64_t stamp_ns, std::int64_t filter_ns) {
  if (stamp_ns <= 0 || stamp_ns < filter_ns) {
    throw std::invalid_argument("a pose of " + std::to_string(stamp_ns) +
                                " ns is older than the filter, of " + std::to_string(filter_ns) +
                                " ns");
  }
}

LandmarkRecord recordOf(const LandmarkEstimate& estimate,
                        const FeatureMatchers& matchers,
                        const FastSlamParameters& parameters) {
  Feature feature;
  feature.position_m = estimate.mean_m;
  feature.covariance_m2 = estimate.covariance_m2;
  requireGood(feature);
  LandmarkRecord record;
  record.id = estimate.id;
  record.type = estimate.type;
  record.classifier = std::make_shared<const std::string>(estimate.classifier);
  const DescriptorPointer appearance = parseDescriptor(matchers, record.type, estimate.classifier);
  if (appearance != nullptr) record.descriptors.push_back(appearance);
  record.existence_log_odds = std::clamp(estimate.existence_log_odds, parameters.delete_log_odds,
                                         parameters.maximum_log_odds);
  record.was_confirmed = record.existence_log_odds >= parameters.confirm_log_odds;
  record.orientation_rad = estimate.orientation_rad;
  record.orientation_variance_rad2 = estimate.orientation_variance_rad2;
  record.placed_ns = estimate.placed_ns;
  return record;
}

std::vector<DescriptorPointer> describe(const FeatureList& list, const FeatureMatchers& matchers) {
  std::vector<DescriptorPointer> descriptors;
  descriptors.reserve(list.features.size());
  for (const Feature& feature : list.features)
    descriptors.push_back(parseDescriptor(matchers, feature.type, feature.classifier));
  return descriptors;
}

void rememberSighting(LandmarkRecord& record,
                      const Particle& particle,
                      const DescribedFeature& seen,
                      const FeatureMatchers& matchers,
                      const AppearanceParameters& parameters) {
  const Eigen::Vector2d robot_from_landmark_m =
      particle.map_from_base.translation() - particle.landmarks.find(record.id)->mean_m;
  addSighting(record, robot_from_landmark_m, findMatcher(matchers, record.type), seen.descriptor,
              parameters);
  addOrientation(record, particle.map_from_base.yaw_rad + seen.feature.orientation_rad,
                 seen.feature.orientation_variance_rad2, parameters);
}

Eigen::AlignedBox2d boundsOf(const Eigen::Vector2d& place_m,
                             const Eigen::Matrix2d& covariance_m2,
                             double gate) {
  const double reach_m = std::sqrt(gate) * std::sqrt(covariance_m2.trace());
  return {place_m.array() - reach_m, place_m.array() + reach_m};
}

void refreshBounds(LandmarkRecord& record, const std::vector<Particle>& particles, double gate) {
  record.bounds_m.setEmpty();
  for (const Particle& particle : particles) {
    const Landmark* landmark = particle.landmarks.find(record.id);
    if (landmark != nullptr)
      record.bounds_m.extend(boundsOf(landmark->mean_m, landmark->covariance_m2, gate));
  }
}

std::vector<LandmarkId> duplicates(
    const LandmarkRegistry& registry,
    const LandmarkTree& landmarks,
    const std::function<Eigen::Matrix2d(LandmarkId, LandmarkId)>& differenceCovariance,
    const FeatureMatchers& matchers,
    const FastSlamParameters& parameters) {
  const Eigen::Matrix2d floor_m2 =
      parameters.feature_noise_floor * parameters.feature_noise_floor * Eigen::Matrix2d::Identity();
  std::vector<LandmarkId> found;
  const std::vector<LandmarkRecord>& records = registry.records();
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Landmark* younger = landmarks.find(records[i].id);
    if (younger == nullptr) continue;
    for (std::size_t j = 0; j < i; ++j) {
      if (records[j].type != records[i].type ||
          !records[j].bounds_m.intersects(records[i].bounds_m))
        continue;
      const Landmark* older = landmarks.find(records[j].id);
      if (older == nullptr) continue;
      const Eigen::Vector2d apart_m = younger->mean_m - older->mean_m;
      const Eigen::Matrix2d covariance_m2 =
          differenceCovariance(records[i].id, records[j].id) + floor_m2;
      if (apart_m.dot(covariance_m2.inverse() * apart_m) > parameters.creation_gate) continue;
      if (!records[i].descriptors.empty() &&
          logLikelihoodRatio(findMatcher(matchers, records[i].type), records[i].descriptors.front(),
                             records[j].descriptors) < 0.0)
        continue;
      found.push_back(records[i].id);
      break;
    }
  }
  return found;
}

}  // namespace ram_slam
