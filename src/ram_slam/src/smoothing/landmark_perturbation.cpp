// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/smoothing/landmark_perturbation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "ram_slam/smoothing/landmark_adjustment.hpp"

namespace ram_slam {

double objective(const LandmarkProblem& problem, const LandmarkSmootherParameters& parameters) {
  const auto unpaired =
      std::count_if(problem.readings.begin(), problem.readings.end(),
                    [](const FeatureReading& reading) { return !reading.isPaired(); });
  return problem.cost +
         0.5 * parameters.reading_share * parameters.association_gate *
             static_cast<double>(unpaired) +
         parameters.least_evidence * static_cast<double>(problem.landmarks.size());
}

void shiftPart(LandmarkProblem& problem, double deviation_m, Random& random) {
  const auto count = static_cast<double>(problem.poses.size());
  const auto begin = static_cast<std::size_t>(1.0 + random.uniform() * (count - 1.0));
  const auto length = static_cast<std::size_t>(std::pow(count, random.uniform()));
  const double x_m = deviation_m * random.gaussian();
  const double y_m = deviation_m * random.gaussian();
  for (std::size_t i = begin; i < std::min(problem.poses.size(), begin + length); ++i) {
    problem.poses[i][0] += x_m;
    problem.poses[i][1] += y_m;
  }
}

bool perturb(LandmarkProblem& problem,
             const FeaturePairing& pairing,
             const LandmarkSmootherParameters& parameters,
             Random random) {
  LandmarkProblem before = problem;
  if (random.uniform() < parameters.perturbation.removal_share && !problem.landmarks.empty()) {
    const double place = random.uniform() * static_cast<double>(problem.landmarks.size());
    problem.landmarks.erase(problem.landmarks.begin() + static_cast<std::ptrdiff_t>(place));
  } else {
    shiftPart(problem, parameters.perturbation.shift_deviation_m, random);
  }
  for (int round = 0; round < parameters.perturbation.rounds_after_perturbation; ++round) {
    pairing.pair(problem);
    adjust(problem, parameters);
  }
  if (objective(problem, parameters) <
      objective(before, parameters) - parameters.perturbation.min_gain)
    return true;
  problem = std::move(before);
  return false;
}

}  // namespace ram_slam
