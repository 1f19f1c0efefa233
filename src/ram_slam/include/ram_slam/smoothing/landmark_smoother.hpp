// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_slam/geometry/pose2.hpp"
#include "ram_slam/geometry/trajectory.hpp"
#include "ram_slam/landmarks/feature.hpp"
#include "ram_slam/landmarks/landmark_map.hpp"

namespace ram_slam {

/// Settings of smoothLandmarks(). Names are the keys of config/landmark_smoother.yaml, which
/// explains them one by one.
struct LandmarkSmootherParameters {
  double reading_share = 0.2;      ///< share of a feature's information that is new, (0, 1]: errors
                                   ///< of successive readings are alike
  double robust_chi2 = 9.0;        ///< squared Mahalanobis distance at which a feature counts half
  double association_gate = 16.0;  ///< bound of the squared Mahalanobis distance of a pair
  double first_deviation_m = 0.3;  ///< standard deviation of landmarks in the first pairing, per
                                   ///< axis; it shrinks from round to round
  double last_deviation_m = 0.02;  ///< to this, <= first_deviation_m
  double least_evidence = 7.0;     ///< [nat] what a landmark explains beyond what its neighbours do
  int round_count = 15;            ///< of pairing and least squares
  int attempt_count = 100;         ///< to agree better by chance changes, >= 0

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads every key of LandmarkSmootherParameters. \throws std::invalid_argument for a wrong type or
/// a value out of bounds
LandmarkSmootherParameters readLandmarkSmootherParameters(ram_parameters::ParameterReader& reader);

/// A list of features, and how odometry says that the robot got there.
struct FeatureStep {
  FeatureList list;
  PoseWithCovariance2 motion;  ///< the base, seen from that of the list before; of no use in the
                               ///< first one. The covariance may be singular.
};

struct SmoothedLandmarks {
  Trajectory trajectory;  ///< map_from_base at every list's stamp
  /// Landmarks keep their identifiers, new ones get the next. Covariances are those of the least
  /// squares, seen from the first pose, without those of two landmarks. The existence is the
  /// evidence for the landmark: what it explains beyond what its neighbours do.
  LandmarkMap map;
};

/// The trajectory and the landmarks that agree best with all features and the odometry at once, for
/// features that a filter cannot pair for certain one reading after the other. The filter's result
/// is where it begins; in turn, features are paired with landmarks as wholes (mutual exclusion, the
/// least sum of squared Mahalanobis distances per list), and the least squares over all poses and
/// landmarks are solved (Lu and Milios 1997; Thrun and Montemerlo, IJRR 2006) with a Cauchy kernel
/// against wrong pairs. In between, landmarks that explain too little are removed, and some are
/// made where enough features are left over. Last, landmarks are left out or parts of the drive
/// shifted at random, and all is paired anew, which is kept where it agrees better: a whole visit
/// may have been paired with the neighbours of what it saw (iterated local search). The first pose
/// stays where it is. Not for live use: all readings are gone through in every round.
///
/// \param steps  in the order of their stamps (several sensors' lists may share one), features that
///   show one thing at most once
/// \param trajectory  of the filter, over the time of the steps
/// \param landmarks  of the filter; those without a feature in the lists are left out
/// \throws std::invalid_argument if steps are out of order or outside the trajectory, or a feature
///   or motion is no good
/// \throws std::runtime_error if the solver fails
SmoothedLandmarks smoothLandmarks(const std::vector<FeatureStep>& steps,
                                  const Trajectory& trajectory,
                                  const std::vector<LandmarkEstimate>& landmarks,
                                  const LandmarkSmootherParameters& parameters);

}  // namespace ram_slam
