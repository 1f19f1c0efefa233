// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"
#include "ram_slam/smoothing/landmark_problem.hpp"
#include "ram_slam/smoothing/landmark_smoother_parameters.hpp"

namespace ram_slam {

struct SmoothedLandmarks {
  Trajectory trajectory;  ///< map_from_base at every list's stamp
  /// Landmarks keep their identifiers, new ones get the next. Covariances are those of the least
  /// squares, seen from the first pose, without those of two landmarks. The existence is the
  /// evidence for the landmark: what it explains beyond what its neighbours do.
  LandmarkMap map;
};

/// The trajectory and the landmarks that agree best with all features and the odometry at once, for
/// features that a filter cannot pair for certain one reading after the other. The filter's result
/// is where it begins; in turn, features are paired with landmarks (pairFeatures()), and the least
/// squares over all poses and landmarks are solved (adjust(); Lu and Milios 1997; Thrun and
/// Montemerlo, IJRR 2006). In between, landmarks that explain too little are removed, and some are
/// made where enough features are left over. Last, the solution is perturbed at random
/// (perturb(); iterated local search). The first pose stays where it is. Not for live use: all
/// readings are gone through in every round.
///
/// \param steps  in the order of their stamps (several sensors' lists may share one), features that
///   show one thing at most once
/// \param trajectory  of the filter, over the time of the steps
/// \param landmarks  of the filter; those without a feature in the lists are left out
/// \throws std::invalid_argument if steps are out of order or outside the trajectory, or a feature
///   or motion is not finite or its covariance not positive definite
/// \throws std::runtime_error if the solver fails
SmoothedLandmarks smoothLandmarks(const std::vector<FeatureStep>& steps,
                                  const Trajectory& trajectory,
                                  const std::vector<LandmarkEstimate>& landmarks,
                                  const LandmarkSmootherParameters& parameters);

}  // namespace ram_slam
