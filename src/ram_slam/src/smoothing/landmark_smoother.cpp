// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_smoother.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "ram_slam/geometry/random.hpp"
#include "ram_slam/smoothing/feature_pairing.hpp"
#include "ram_slam/smoothing/landmark_adjustment.hpp"
#include "ram_slam/smoothing/landmark_perturbation.hpp"

namespace ram_slam {
namespace {

/// Pairs and adjusts in rounds in which the deviation of the landmarks shrinks.
void smoothInRounds(LandmarkProblem& problem,
                    FeaturePairing& pairing,
                    const LandmarkSmootherParameters& parameters) {
  const double shrink = std::pow(parameters.last_deviation_m / parameters.first_deviation_m,
                                 1.0 / std::max(1, parameters.round_count - 1));
  double deviation_m = parameters.first_deviation_m;
  for (int round = 1; round <= parameters.round_count; ++round) {
    pairing.setDeviation(deviation_m);
    pairing.pair(problem);
    adjust(problem, parameters);
    if (round == parameters.round_count) break;
    if (round % parameters.rounds_between_revisions == 0) pairing.revise(problem);
    deviation_m *= shrink;
  }
  pairing.pair(problem);
  adjust(problem, parameters);
}

SmoothedLandmarks resultOf(LandmarkProblem& problem,
                           const FeaturePairing& pairing,
                           const LandmarkSmootherParameters& parameters) {
  const std::vector<double> evidence = pairing.evidence(problem);
  const std::vector<bool> is_paired = pairedLandmarks(problem);
  computeCovariances(problem, parameters);
  SmoothedLandmarks result;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const std::array<double, 3>& pose = problem.poses[i];
    result.trajectory.push_back({problem.stamps_ns[i], {pose[0], pose[1], wrapAngle(pose[2])}});
  }
  result.map.stamp_ns = problem.stamps_ns.back();
  for (std::size_t j = 0; j < problem.landmarks.size(); ++j) {
    if (!is_paired[j] || evidence[j] < parameters.least_evidence) continue;
    result.map.landmarks.push_back(problem.landmarks[j]);
    result.map.landmarks.back().existence_log_odds = evidence[j];
  }
  return result;
}

}  // namespace

SmoothedLandmarks smoothLandmarks(const std::vector<FeatureStep>& steps,
                                  const Trajectory& trajectory,
                                  const std::vector<LandmarkEstimate>& landmarks,
                                  const LandmarkSmootherParameters& parameters) {
  parameters.validate();
  validate(trajectory);
  LandmarkProblem problem = makeLandmarkProblem(steps, trajectory, landmarks, parameters);
  if (problem.stamps_ns.empty()) return {};
  FeaturePairing pairing(parameters);
  smoothInRounds(problem, pairing, parameters);
  for (int attempt = 0; attempt < parameters.attempt_count; ++attempt)
    perturb(problem, pairing, parameters, Random(0, static_cast<std::uint64_t>(attempt)));
  return resultOf(problem, pairing, parameters);
}

}  // namespace ram_slam
