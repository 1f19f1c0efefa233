// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/smoothing/landmark_problem.hpp"
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"

namespace ram_slam {

/// Moves poses and landmarks to the least squares over all motions and paired features, with a
/// Cauchy kernel against wrong pairs; the first pose stays where it is. Sets the cost.
/// \throws std::runtime_error if the solver fails
void adjust(LandmarkProblem& problem, const LandmarkSmootherParameters& parameters);

/// Whether each landmark is paired with a feature.
std::vector<bool> pairedLandmarks(const LandmarkProblem& problem);

/// Sets the covariances of paired landmarks: their blocks of the inverse of J^T J, the first pose
/// being known. Nothing without any.
/// \throws std::runtime_error if that is singular
void computeCovariances(LandmarkProblem& problem, const LandmarkSmootherParameters& parameters);

}  // namespace ram_slam
