// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ram_parameters/parameter_reader.hpp"

namespace ram_slam {

/// Which filter, and with it which association.
enum class FastSlamMode {
  kFastSlam1,  ///< Montemerlo 2002: particles drawn from the motion model, Euclidean gates,
               ///< resampled every time
  kFastSlam2,  ///< Montemerlo 2003: particles drawn with the features in view, Mahalanobis x
               ///< classifier
};

/// Settings of FastSlam. Names are the keys of config/fast_slam.yaml, which explains them one by
/// one.
struct FastSlamParameters {
  int particle_amount = 100;
  double feature_match_distance =
      0.1;  ///< [m], only fast_slam_1: nearer than this is the same landmark
  double minimum_feature_separation = 0.3;  ///< [m] nearer than this to a landmark none is created
  double future_interpol = 0.1;  ///< [s] how long the published pose is valid; the node's to use
  FastSlamMode mode = FastSlamMode::kFastSlam2;
  int seed = 1;

  double update_distance = 0.1;  ///< [m] fast_slam_2: the map learns once per this distance driven
  double update_angle = 0.1;  ///< [rad] or angle turned; in between features only correct the pose

  double association_gate =
      9.21;  ///< bound of the squared Mahalanobis distance; 99 % of chi2 with 2 dof
  double creation_gate = 25.0;   ///< likewise: nearer to a landmark than this nothing is new
  double duplicate_gate = 9.21;  ///< two features of one reading nearer to each other (squared
                                 ///< Mahalanobis distance) may show the same thing
  double ambiguity_margin =
      1.0;                    ///< [nat] a pairing that beats its alternatives by less is not used
  bool draw_jointly = false;  ///< such pairings of one reading are drawn together and weigh as much
                              ///< as all alternatives, not one by one and as what was drawn
  double unknown_feature_density =
      0.05;                           ///< [1/m^2] of features that belong to no landmark of the map
  double feature_noise_floor = 0.03;  ///< [m] added in quadrature to what the detector states
  double evidence_exponent = 1.0;   ///< of the weights: < 1 where errors of successive readings are
                                    ///< alike, so that they count for less
  double resample_threshold = 0.5;  ///< resample below this fraction of effective particles

  double drift_inflation = 1.0;  ///< variance of the drift over that of the motion model: how much
                                 ///< more than white noise the odometry's errors add up to
  double pose_noise_floor = 0.01;  ///< [m] what errors that features have in common leave in the
                                   ///< pose per axis, and in its yaw at the distance of 5 m: half
                                   ///< of it where the ground is known, up to twice on new ground

  double detection_probability = 0.5;         ///< that a landmark in view is found in one reading
  double false_detection_probability = 0.05;  ///< that something is found where no landmark is
  double confirm_log_odds = 2.0;              ///< only landmarks above this correct the pose
  double delete_log_odds = -2.0;              ///< landmarks below this are removed
  double maximum_log_odds = 8.0;              ///< more certain than this a landmark never gets

  /// \throws std::invalid_argument naming the parameter, its value and the bound it breaks
  void validate() const;
};

/// Reads every key of FastSlamParameters; the section `node` is left to the node,
/// `relocalisation` to readRecoveryParameters().
/// `minimum_feature_seperation`, the spelling of older files, is accepted if the right spelling
/// does not contradict it. \throws std::invalid_argument for an unknown key, a wrong type or a
/// value out of bounds
FastSlamParameters readFastSlamParameters(ram_parameters::ParameterReader& reader);

}  // namespace ram_slam
