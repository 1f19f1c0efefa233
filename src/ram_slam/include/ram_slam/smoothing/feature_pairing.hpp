// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ram_slam/smoothing/landmark_problem.hpp"
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"

namespace ram_slam {

/// Pairs features with landmarks, at given poses.
class FeaturePairing {
public:
  explicit FeaturePairing(const LandmarkSmootherParameters& parameters)
      : parameters_(parameters), deviation_m_(parameters.first_deviation_m) {}

  /// \param deviation_m  standard deviation of every landmark, per axis
  void setDeviation(double deviation_m) { deviation_m_ = deviation_m; }

  /// [nat] that a feature shows a landmark at a place rather than nothing known: (gate - chi2) / 2,
  /// at least 0.
  double score(const LandmarkProblem& problem,
               const FeatureReading& reading,
               const Eigen::Vector2d& landmark_m) const;

  /// Pairs every list's features with landmarks of their type, each landmark at most once per list,
  /// with the largest sum of scores.
  void pair(LandmarkProblem& problem) const;

  /// [nat] that the pairs would lose without each landmark.
  std::vector<double> evidence(const LandmarkProblem& problem) const;

  /// Pairs, removes landmarks that explain too little, the least first, and makes new ones where
  /// enough features are left over.
  void revise(LandmarkProblem& problem) const;

private:
  void pairList(LandmarkProblem& problem, std::size_t first, std::size_t end) const;
  void removeUnexplained(LandmarkProblem& problem) const;
  void addUnpaired(LandmarkProblem& problem) const;
  /// [nat] what a landmark at an unpaired feature would explain of all unpaired ones.
  double evidenceAt(const LandmarkProblem& problem,
                    const FeatureReading& reading,
                    const std::vector<const FeatureReading*>& unpaired) const;

  LandmarkSmootherParameters parameters_;
  double deviation_m_;
};

}  // namespace ram_slam
