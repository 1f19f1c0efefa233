// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_parameters/parameter_reader.hpp"
#include "ram_parameters/parameter_table.hpp"

namespace ram_slam {

/// Settings of the attempts to agree better by random changes.
struct PerturbationParameters {
  double shift_deviation_m = 0.2;     ///< of a random shift of a part of the drive, per axis
  double removal_share = 0.3;         ///< of the attempts leave out a landmark, the others shift
  int rounds_after_perturbation = 3;  ///< of pairing and least squares
  double min_gain = 0.1;              ///< [nat] by which an attempt must agree better to be kept

  static const ram_parameters::ParameterTable<PerturbationParameters>& table();
};

/// Settings of smoothLandmarks(). Names are the keys of config/landmark_smoother.yaml.
struct LandmarkSmootherParameters {
  std::string map_frame = "map";         ///< frame of the estimator's trajectory and landmarks
  std::string base_frame = "base_link";  ///< frame of the features
  double motion_patience_s = 2.0;        ///< by the stamps of newer features

  double reading_share = 0.2;      ///< share of a feature's information that is new, (0, 1]: errors
                                   ///< of successive readings are alike
  double robust_chi2 = 9.0;        ///< squared Mahalanobis distance at which a feature counts half
  double association_gate = 16.0;  ///< bound of the squared Mahalanobis distance of a pair
  double first_deviation_m = 0.3;  ///< standard deviation of landmarks in the first pairing, per
                                   ///< axis; it shrinks from round to round
  double last_deviation_m = 0.02;  ///< to this, <= first_deviation_m
  double least_evidence = 7.0;     ///< [nat] what a landmark explains beyond what its neighbours do
  int round_count = 15;            ///< of pairing and least squares
  int attempt_count = 100;         ///< to agree better by random changes, >= 0

  int rounds_between_revisions = 5;  ///< of the landmarks
  int max_iterations = 10;           ///< of one least-squares solution
  double precision = 1e-5;           ///< relative change of the cost at which it ends
  double rest_deviation_m = 1e-3;    ///< added to the odometry's deviation, which may be 0 for a
  double rest_deviation_rad = 1e-3;  ///< robot at rest
  PerturbationParameters perturbation;

  static const ram_parameters::ParameterTable<LandmarkSmootherParameters>& table();
  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const { table().check(*this); }
};

/// \throws std::invalid_argument for an unknown key, a wrong type or a value out of bounds
LandmarkSmootherParameters readLandmarkSmootherParameters(ram_parameters::ParameterReader& reader);

}  // namespace ram_slam
