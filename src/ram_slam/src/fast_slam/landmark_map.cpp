// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_map.hpp"

#include <cmath>

namespace ram_slam {
namespace {

constexpr double kFarthestPair_m = 5.0;
constexpr double kLeastCorrelation = 0.1;

/// A landmark's deviation from its mean in every particle, times the square root of the weight;
/// zero where a particle does not hold it.
using Deviations = Eigen::Matrix<double, 2, Eigen::Dynamic>;

struct Summary {
  LandmarkEstimate estimate;
  Deviations deviations;
};

Summary summarise(const LandmarkRecord& record,
                  const std::vector<Particle>& particles,
                  const std::vector<double>& weights) {
  Summary summary;
  LandmarkEstimate& estimate = summary.estimate;
  estimate.id = record.id;
  estimate.type = record.type;
  estimate.classifier = record.classifier;
  estimate.existence_log_odds = record.existence_log_odds;
  estimate.orientation_rad = record.orientation_rad;
  estimate.orientation_variance_rad2 = record.orientation_variance_rad2;
  double held_weight = 0.0;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Landmark* landmark = particles[k].landmarks.find(record.id);
    if (landmark == nullptr) continue;
    held_weight += weights[k];
    estimate.mean_m += weights[k] * landmark->mean_m;
  }
  estimate.mean_m /= held_weight;
  estimate.covariance_m2.setZero();
  summary.deviations.setZero(2, static_cast<Eigen::Index>(particles.size()));
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Landmark* landmark = particles[k].landmarks.find(record.id);
    if (landmark == nullptr) continue;
    const double weight = weights[k] / held_weight;
    summary.deviations.col(static_cast<Eigen::Index>(k)) =
        std::sqrt(weight) * (landmark->mean_m - estimate.mean_m);
    estimate.covariance_m2 += weight * landmark->covariance_m2;
  }
  estimate.covariance_m2 += summary.deviations * summary.deviations.transpose();
  return summary;
}

bool correlated(const Eigen::Matrix2d& cross,
                const LandmarkEstimate& a,
                const LandmarkEstimate& b) {
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      const double scale = std::sqrt(a.covariance_m2(row, row) * b.covariance_m2(column, column));
      if (std::abs(cross(row, column)) > kLeastCorrelation * scale) return true;
    }
  }
  return false;
}

}  // namespace

LandmarkMap summarise(const LandmarkRegistry& registry,
                      const Particle& chosen,
                      const std::vector<Particle>& particles,
                      const std::vector<double>& weights) {
  std::vector<Summary> summaries;
  for (const LandmarkRecord& record : registry.records()) {
    if (chosen.landmarks.find(record.id) != nullptr) {
      summaries.push_back(summarise(record, particles, weights));
    }
  }
  LandmarkMap map;
  for (std::size_t i = 0; i < summaries.size(); ++i) {
    const LandmarkEstimate& first = summaries[i].estimate;
    for (std::size_t j = i + 1; j < summaries.size(); ++j) {
      const LandmarkEstimate& second = summaries[j].estimate;
      if ((first.mean_m - second.mean_m).norm() > kFarthestPair_m) continue;
      const Eigen::Matrix2d cross = summaries[i].deviations * summaries[j].deviations.transpose();
      if (correlated(cross, first, second)) map.covariances.push_back({first.id, second.id, cross});
    }
    map.landmarks.push_back(first);
  }
  return map;
}

}  // namespace ram_slam
