// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ram_slam/geometry/random.hpp"
#include "ram_slam/smoothing/feature_pairing.hpp"
#include "ram_slam/smoothing/landmark_problem.hpp"
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"

namespace ram_slam {

/// [nat] what pairing and least squares minimise: the cost of the least squares, a share of the
/// gate for each unpaired feature, and the least evidence for each landmark.
double objective(const LandmarkProblem& problem, const LandmarkSmootherParameters& parameters);

/// Shifts a random part of the drive. Parts of all lengths are as likely by order of magnitude; the
/// first pose is fixed.
void shiftPart(LandmarkProblem& problem, double deviation_m, Random& random);

/// Leaves out a landmark, or shifts a part of the drive, pairs and adjusts again, and keeps that if
/// the objective falls: a landmark may be there twice, and what was seen on one visit may have been
/// paired with the neighbours of what it was, all at once (iterated local search).
/// \return whether it was kept
bool perturb(LandmarkProblem& problem,
             const FeaturePairing& pairing,
             const LandmarkSmootherParameters& parameters,
             Random random);

}  // namespace ram_slam
