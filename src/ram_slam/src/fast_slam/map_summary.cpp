// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/map_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ram_slam {
namespace {

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
  estimate.classifier = *record.classifier;
  estimate.existence_log_odds = record.existence_log_odds;
  estimate.orientation_rad = record.orientation_rad;
  estimate.orientation_variance_rad2 = record.orientation_variance_rad2;
  estimate.placed_ns = record.placed_ns;
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

/// For each landmark those after it that are near enough to be correlated.
std::vector<std::vector<std::size_t>> neighboursAfter(const std::vector<Summary>& summaries,
                                                      double distance_m) {
  std::vector<std::size_t> by_x(summaries.size());
  std::iota(by_x.begin(), by_x.end(), 0U);
  std::sort(by_x.begin(), by_x.end(), [&summaries](std::size_t a, std::size_t b) {
    return summaries[a].estimate.mean_m.x() < summaries[b].estimate.mean_m.x();
  });
  std::vector<std::vector<std::size_t>> neighbours(summaries.size());
  for (std::size_t a = 0; a < by_x.size(); ++a) {
    const Eigen::Vector2d& here_m = summaries[by_x[a]].estimate.mean_m;
    for (std::size_t b = a + 1; b < by_x.size(); ++b) {
      const Eigen::Vector2d& there_m = summaries[by_x[b]].estimate.mean_m;
      if (there_m.x() - here_m.x() > distance_m) break;
      if ((there_m - here_m).norm() > distance_m) continue;
      neighbours[std::min(by_x[a], by_x[b])].push_back(std::max(by_x[a], by_x[b]));
    }
  }
  for (std::vector<std::size_t>& each : neighbours) std::sort(each.begin(), each.end());
  return neighbours;
}

bool correlated(const Eigen::Matrix2d& cross,
                const LandmarkEstimate& a,
                const LandmarkEstimate& b,
                double least_correlation) {
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      const double scale = std::sqrt(a.covariance_m2(row, row) * b.covariance_m2(column, column));
      if (std::abs(cross(row, column)) > least_correlation * scale) return true;
    }
  }
  return false;
}

}  // namespace

LandmarkMap summarise(const LandmarkRegistry& registry,
                      const Particle& chosen,
                      const std::vector<Particle>& particles,
                      const std::vector<double>& weights,
                      const MapSummaryParameters& parameters) {
  std::vector<Summary> summaries;
  for (const LandmarkRecord& record : registry.records()) {
    const bool is_doubted = record.was_confirmed && record.existence_log_odds <= 0.0;
    if (is_doubted || chosen.landmarks.find(record.id) == nullptr) continue;
    summaries.push_back(summarise(record, particles, weights));
  }
  LandmarkMap map;
  const std::vector<std::vector<std::size_t>> later =
      neighboursAfter(summaries, parameters.pair_distance_m);
  for (std::size_t i = 0; i < summaries.size(); ++i) {
    const LandmarkEstimate& first = summaries[i].estimate;
    for (const std::size_t j : later[i]) {
      const LandmarkEstimate& second = summaries[j].estimate;
      const Eigen::Matrix2d cross = summaries[i].deviations * summaries[j].deviations.transpose();
      if (correlated(cross, first, second, parameters.least_correlation))
        map.covariances.push_back({first.id, second.id, cross});
    }
    map.landmarks.push_back(first);
  }
  return map;
}

}  // namespace ram_slam
